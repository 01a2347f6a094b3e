//! Writing a mission.

use super::{
    Action, Behaviour, Description, Edge, Fact, Input, Interval, Mission, MissionError, Name,
    PlanFrame, Production, Rule, RuleBase, Sections,
};
use crate::limits;
use crate::record::Record;

/// A mission that is being built: the tables of [`Mission`], as vectors.
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
    /// The edges of a production; none if it names others than there are.
    pub fn edges_of(&self, production: &Production) -> &[Edge] {
        let first = usize::from(production.first_edge);
        self.edges.get(first..first + usize::from(production.edges)).unwrap_or_default()
    }

    /// Puts a name into the name table, once.
    ///
    /// A name that exceeds [`limits::MAX_NAME_BYTES`] or [`limits::MAX_MISSION_NAMES_BYTES`] is not
    /// stored; [`MissionDraft::write`] then returns [`MissionError::Name`] for the record that uses
    /// it.
    pub fn name(&mut self, text: &str) -> Name {
        if text.len() > limits::MAX_NAME_BYTES {
            return NOT_STORED;
        }
        let offset = match self.names.find(text) {
            Some(offset) => offset,
            None if self.names.len() + text.len() <= limits::MAX_MISSION_NAMES_BYTES => {
                self.names.push_str(text);
                self.names.len() - text.len()
            }
            None => return NOT_STORED,
        };
        // The limits keep offsets below 2^16 and lengths below 2^8.
        Name { offset: offset as u16, length: text.len() as u8 }
    }

    /// The bytes of the section; empty without behaviours. Returns an error if [`Mission::parse`]
    /// would refuse them.
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

/// The name of a record whose text is not in the name table, which is never this long.
const NOT_STORED: Name = Name { offset: u16::MAX, length: u8::MAX };

fn table<T: Record>(records: &[T]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(records.len() * T::SIZE);
    for record in records {
        record.encode(&mut bytes);
    }
    bytes
}
