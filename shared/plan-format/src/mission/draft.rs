//! Writing a mission.

use super::{
    Action, Behaviour, Description, Edge, Fact, Input, Interval, Mission, MissionError, Name,
    PlanFrame, Production, Rule, RuleBase, Sections,
};
use crate::record::Record;

/// A mission as the compiler builds it: the same tables, growing.
#[derive(Clone, Debug, Default)]
#[allow(missing_docs, reason = "the tables of `Mission`, by the same names")]
pub struct MissionDraft {
    pub inputs: Vec<Input>,
    pub rules: Vec<Rule>,
    pub rule_bases: Vec<RuleBase>,
    pub facts: Vec<Fact>,
    pub descriptions: Vec<Description>,
    pub actions: Vec<Action>,
    pub frames: Vec<PlanFrame>,
    pub productions: Vec<Production>,
    pub edges: Vec<Edge>,
    pub intervals: Vec<Interval>,
    pub behaviours: Vec<Behaviour>,
    names: String,
}

impl MissionDraft {
    /// Puts a name into the name table, once.
    ///
    /// # Panics
    /// If the names of a mission exceed 64 KiB; limits on their number and length prevent that.
    pub fn name(&mut self, text: &str) -> Name {
        let offset = self.names.find(text).unwrap_or_else(|| {
            self.names.push_str(text);
            self.names.len() - text.len()
        });
        let fits = "the limits keep names within 64 KiB";
        Name { offset: offset.try_into().expect(fits), length: text.len().try_into().expect(fits) }
    }

    /// The bytes of the section; empty without behaviours. Refuses what the reader would refuse.
    pub fn write(&self) -> Result<Vec<u8>, MissionError> {
        if self.behaviours.is_empty() {
            return Ok(Vec::new());
        }
        let bytes = postcard::to_stdvec(&Sections {
            inputs: &table(&self.inputs),
            rules: &table(&self.rules),
            rule_bases: &table(&self.rule_bases),
            facts: &table(&self.facts),
            descriptions: &table(&self.descriptions),
            actions: &table(&self.actions),
            frames: &table(&self.frames),
            productions: &table(&self.productions),
            edges: &table(&self.edges),
            intervals: &table(&self.intervals),
            behaviours: &table(&self.behaviours),
            names: self.names.as_bytes(),
        })
        .map_err(|_| MissionError::Tables)?;
        Mission::parse(&bytes)?;
        Ok(bytes)
    }
}

fn table<T: Record>(records: &[T]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(records.len() * T::SIZE);
    for record in records {
        record.encode(&mut bytes);
    }
    bytes
}
