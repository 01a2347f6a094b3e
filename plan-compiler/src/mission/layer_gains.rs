//! `[layer_gains]`: what a metre of each layer counts when the layer is selected by gains.

use super::{Mission, Named, Reader};
use crate::behaviours;
use crate::toml::{Fields, Report, key_span};
use maps::names::nearest;
use maps::problem::Problem;
use plan_format::parameters::{LayerGain, LayerGains, Selection};
use toml_edit::{Item, TableLike};

/// The gain of one layer.
#[derive(Clone, Debug)]
pub struct NamedGain {
    /// The layer.
    pub layer: Named,
    /// What a metre of it counts.
    pub gain: LayerGain,
}

const EXAMPLE: &str = "comms = 0.7, or comms = { gain = 0.7, channel = \"custom 1\" }";

impl Reader<'_> {
    /// Reads the table `[layer_gains]`.
    pub(super) fn layer_gains(&mut self, table: &dyn TableLike) {
        for (name, item) in table.iter() {
            let place = self.report.place(&key_span(table, name));
            let gain = gain(&mut self.report, table, name, item);
            let layer = Named { name: name.trim().to_owned(), place };
            self.mission.layer_gains.extend(gain.map(|gain| NamedGain { layer, gain }));
        }
    }
}

fn gain(
    report: &mut Report<'_>,
    table: &dyn TableLike,
    name: &str,
    item: &Item,
) -> Option<LayerGain> {
    let (path, span) = (format!("layer_gains.{name}"), key_span(table, name));
    let range = 0.0..=f64::from(LayerGains::MOST);
    let Some(inner) = item.as_table_like() else {
        let here = item.span().unwrap_or(span);
        let number = item.as_value().and_then(crate::toml::number);
        return match number.filter(|number| range.contains(number)) {
            Some(number) => Some(LayerGain { gain: number as f32, channel: None }),
            None => {
                let expected = format!("a number from 0 to {}", LayerGains::MOST);
                report.wrong_type(&path, item, &here, &expected, EXAMPLE);
                None
            }
        };
    };
    let fields = Fields::open(report, path, item, span, &["gain", "channel"], EXAMPLE)?;
    let gain = fields.number(report, "gain", range, "");
    let channel = fields.text(report, "channel", "\"custom 1\"");
    if inner.get("gain").is_none() {
        let message = format!("`{}` has no gain", fields.path);
        report.error(message, &fields.span, "used while the channel has no value", "add gain = 1");
    }
    let known = channel.as_ref().map(|channel| (channel, behaviours::channel_of(channel.as_str())));
    if let Some((channel, None)) = known {
        let message = format!("`{}` is not an input channel", channel.as_str());
        let help = "write battery, fuel, link or custom N";
        report.error(message, &channel.span, "this channel", help);
    }
    Some(LayerGain { gain: gain?.value as f32, channel: known.and_then(|(_, number)| number) })
}

/// The mission's way to select layers, with its gains by the positions of the layers in the stack.
///
/// Mistakes: a gain of a layer that the map and the mission do not have, or of any where layers are
/// not selected by gains.
pub(crate) fn selection(
    mission: &Mission,
    layers: &[&str],
    problems: &mut Vec<Problem>,
) -> Selection {
    let Selection::Gains(mut rule) = mission.parameters.selection else {
        problems.extend(mission.layer_gains.first().map(|first| {
            let place = &first.layer.place;
            Problem::error("the layers are not selected by their gains")
                .at(&place.source, place.span.clone(), "this gain has no effect")
                .help("add selection = \"gains\", or remove [layer_gains]")
        }));
        return mission.parameters.selection;
    };
    for named in &mission.layer_gains {
        let name = named.layer.name.as_str();
        match layers.iter().position(|layer| *layer == name) {
            Some(rank) => {
                if let Some(slot) = rule.gains.get_mut(rank) {
                    *slot = named.gain;
                }
            }
            None => {
                let help = match nearest(name, layers.iter().copied()) {
                    Some(meant) => format!("did you mean `{meant}`?"),
                    None => format!("the layers are {}", layers.join(", ")),
                };
                let place = &named.layer.place;
                problems.push(
                    Problem::error(format!("there is no layer `{name}`"))
                        .at(&place.source, place.span.clone(), "this gain")
                        .help(help),
                );
            }
        }
    }
    if let Some(share) = mission.selection_hysteresis {
        rule.hysteresis = share as f32;
    }
    Selection::Gains(rule)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::tests::read;

    /// The gains by rank and the mistakes of a mission whose stack has three layers.
    fn gains(text: &str) -> (Vec<(f32, Option<u8>)>, Vec<String>) {
        let (mission, mut mistakes) = read(text);
        let mut problems = Vec::new();
        let layers = ["physical", "comms", "night"];
        let gains = match selection(&mission, &layers, &mut problems) {
            Selection::Gains(rule) => rule.gains[..3].iter().map(|g| (g.gain, g.channel)).collect(),
            Selection::Static | Selection::Dynamic => Vec::new(),
        };
        mistakes.extend(problems.iter().map(ToString::to_string));
        (gains, mistakes)
    }

    #[test]
    fn gains_belong_to_layers_and_may_come_from_channels() {
        let (found, mistakes) = gains(
            "selection = \"gains\"\n[layer_gains]\nnight = { gain = 0.5, channel = \"custom 2\" }\n\
             comms = 0.75\n",
        );
        assert_eq!(mistakes, [""; 0]);
        assert_eq!(found, [(1.0, None), (0.75, None), (0.5, Some(4))]);
    }

    #[test]
    fn mistakes_in_gains() {
        for (text, expected) in [
            ("[layer_gains]\ncomms = 0.5\n", "the layers are not selected by their gains"),
            ("selection = \"gains\"\n[layer_gains]\ncoms = 0.5\n", "there is no layer `coms`"),
            (
                "selection = \"gains\"\n[layer_gains]\ncomms = -1\n",
                "`layer_gains.comms` must be a number from 0 to 1000",
            ),
            (
                "selection = \"gains\"\n[layer_gains]\ncomms = { gain = 1, channel = \"custom 9\" }\n",
                "`custom 9` is not an input channel",
            ),
            (
                "selection = \"gains\"\n[layer_gains]\ncomms = { channel = \"fuel\" }\n",
                "`layer_gains.comms` has no gain",
            ),
        ] {
            assert_eq!(gains(text).1, [expected], "{text}");
        }
    }
}
