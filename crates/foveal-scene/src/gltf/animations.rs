//! Animations: definitions, and their key frames as numbers.
//!
//! A channel that cannot be played is left out with a warning: the rest of the scene still moves.

use serde_json::Value;

use super::accessor::Component;
use super::document::Counts;
use super::json::Obj;
use super::pointers::{Pointed, pointed};
use super::reader::Reader;
use crate::error::{Flaw, Parsed};
use crate::pose::{
    Animation, Channel, Factor, Interpolation, LightPart, MaterialPart, Target, UvPart,
};
use crate::{Code, Warning};

struct SamplerDef {
    input: u32,
    output: u32,
    interpolation: Interpolation,
}

impl SamplerDef {
    fn parse(o: Obj<'_>, counts: &Counts) -> Parsed<Self> {
        Ok(Self {
            input: o.need("input", o.index("input", counts.accessors)?)?,
            output: o.need("output", o.index("output", counts.accessors)?)?,
            interpolation: match o.string("interpolation")? {
                None | Some("LINEAR") => Interpolation::Linear,
                Some("STEP") => Interpolation::Step,
                Some("CUBICSPLINE") => Interpolation::CubicSpline,
                Some(other) => {
                    let cause = format!("\"{other}\" is not an interpolation");
                    return Err(Flaw::new(Code::ValueUnknown, cause).under("interpolation"));
                }
            },
        })
    }
}

struct ChannelDef {
    sampler: u32,
    /// `None` without a node.
    target: Option<Pointed>,
}

impl ChannelDef {
    fn parse(o: Obj<'_>, samplers: usize, root: &Value, counts: &Counts) -> Parsed<Self> {
        let target = o.need("target", o.object("target")?)?;
        Ok(Self {
            sampler: o.need("sampler", o.index("sampler", samplers)?)?,
            target: parse_target(target, root, counts).map_err(|e| e.under("target"))?,
        })
    }
}

/// An animation as the file has it.
#[derive(Default)]
pub(crate) struct AnimationDef {
    name: Option<String>,
    /// Or why they cannot be used, as of channels.
    samplers: Vec<Parsed<SamplerDef>>,
    channels: Vec<Parsed<ChannelDef>>,
}

impl AnimationDef {
    /// `root` is the whole file, into which pointers lead.
    pub(crate) fn parse(o: Obj<'_>, root: &Value, counts: &Counts) -> Parsed<Self> {
        let sampler = |value| Obj::of(value).and_then(|o| SamplerDef::parse(o, counts));
        let samplers = o.each("samplers", |value| Ok(sampler(value)))?;
        let channel = |value| {
            let found = Obj::of(value);
            found.and_then(|o| ChannelDef::parse(o, samplers.len(), root, counts))
        };
        Ok(Self {
            name: o.name("name")?,
            channels: o.each("channels", |value| Ok(channel(value)))?,
            samplers,
        })
    }

    /// What its channels move.
    pub(crate) fn targets(&self) -> impl Iterator<Item = &Pointed> {
        let targets = self.channels.iter();
        targets.filter_map(|channel| channel.as_ref().ok()?.target.as_ref())
    }

    /// The key frames. `weights_of` gives the number of morph targets of a node's mesh.
    pub(crate) fn read(
        &self,
        reader: Reader<'_>,
        weights_of: impl Fn(u32) -> usize,
        warn: &mut Vec<Warning>,
    ) -> Animation {
        let mut channels: Vec<Channel> = Vec::new();
        for (i, def) in self.channels.iter().enumerate() {
            let place = format!("channels[{i}]");
            let def = def.as_ref().map_err(Flaw::clone);
            match def.and_then(|def| self.read_channel(def, reader, &weights_of)) {
                Ok(Some(channel)) => {
                    let twin =
                        |c: &Channel| c.number == channel.number && c.target.meets(channel.target);
                    if channels.iter().rev().take(8).any(twin) {
                        let flaw = Flaw::new(
                            Code::AnimationTwice,
                            "moves what another channel moves already",
                        );
                        warn.push(flaw.under(place).warning());
                    }
                    channels.push(channel);
                }
                Ok(None) => {}
                Err(flaw) => {
                    warn.push(
                        flaw.under(place)
                            .warning()
                            .and("this channel is not played"),
                    );
                }
            }
        }
        Animation::new(self.name.clone().unwrap_or_default(), channels)
    }

    fn read_channel(
        &self,
        def: &ChannelDef,
        reader: Reader<'_>,
        weights_of: impl Fn(u32) -> usize,
    ) -> Parsed<Option<Channel>> {
        // The specification lets channels without a node be ignored.
        let Some(&Pointed { number, target, .. }) = def.target.as_ref() else {
            return Ok(None);
        };
        let place = |e: Flaw, part: &str| e.under(format_args!("sampler {} {part}", def.sampler));
        let sampler = self.samplers[def.sampler as usize]
            .as_ref()
            .map_err(|flaw| {
                let mut flaw = flaw.clone();
                let part = std::mem::take(&mut flaw.place);
                flaw.under(format!("sampler {} {part}", def.sampler).trim_end())
            })?;
        let numbers = |a: u32| reader.accessor(a).count as u64 * reader.accessor(a).width as u64;
        let keys = numbers(sampler.input).saturating_add(numbers(sampler.output));
        let budget = &reader.buffers.budget;
        budget.take(keys.saturating_mul(4), "key frames")?;
        let times: Vec<f32> = reader
            .floats::<1>(sampler.input)
            .map_err(|e| place(e, "input"))?
            .into_iter()
            .map(|[t]| t)
            .collect();
        let ordered = times.is_sorted() && times.iter().all(|t| t.is_finite() && *t >= 0.0);
        if times.is_empty() || !ordered {
            return Err(place(
                Flaw::new(Code::Animation, "is empty or not in ascending order"),
                "input",
            ));
        }
        let width = match target {
            Target::Weights => weights_of(number),
            Target::Weight(weight) => usize::from((weight as usize) < weights_of(number)),
            _ => width_of(target),
        };
        if target == Target::Visible {
            let component = reader.accessor(sampler.output).component;
            if sampler.interpolation != Interpolation::Step || component != Component::U8 {
                let cause = "is of a boolean, which needs unsigned bytes and STEP";
                return Err(place(Flaw::new(Code::Animation, cause), "output"));
            }
        }
        let values: Vec<f32> = match width_of(target) {
            2 => (reader.floats::<2>(sampler.output)).map(|v| v.into_flattened()),
            3 => (reader.floats::<3>(sampler.output)).map(|v| v.into_flattened()),
            4 => (reader.floats::<4>(sampler.output)).map(|v| v.into_flattened()),
            _ => (reader.floats::<1>(sampler.output)).map(|v| v.into_flattened()),
        }
        .map_err(|e| place(e, "output"))?;
        let per_key = match sampler.interpolation {
            Interpolation::CubicSpline => 3,
            _ => 1,
        };
        let needed = times.len() * width * per_key;
        if width == 0 {
            return Err(Flaw::new(
                Code::Animation,
                "moves the weights of a node without such morph targets",
            ));
        }
        if values.len() < needed || !values.iter().all(|v| v.is_finite()) {
            let cause = format!("has {} usable numbers instead of {needed}", values.len());
            return Err(place(Flaw::new(Code::Animation, cause), "output"));
        }
        Ok(Some(Channel {
            number,
            target,
            interpolation: sampler.interpolation,
            width,
            times,
            values,
        }))
    }
}

/// What a channel's target object points at.
fn parse_target(target: Obj<'_>, root: &Value, counts: &Counts) -> Parsed<Option<Pointed>> {
    let node = target.index("node", counts.nodes)?;
    let path = target.need("path", target.string("path")?)?;
    let property = match path {
        "translation" => Target::Translation,
        "rotation" => Target::Rotation,
        "scale" => Target::Scale,
        "weights" => Target::Weights,
        "pointer" => return pointed(target, root, counts).map(Some),
        other => {
            let cause = format!("\"{other}\" cannot be animated");
            return Err(Flaw::new(Code::AnimationUnsupported, cause).under("path"));
        }
    };
    Ok(node.map(|node| Pointed::new(node, property)))
}

/// Numbers of an element of the accessor with a target's values.
fn width_of(target: Target) -> usize {
    match target {
        Target::Translation | Target::Scale => 3,
        Target::Rotation => 4,
        Target::Light(LightPart::Color) => 3,
        Target::Material(MaterialPart::Uv(_, UvPart::Offset | UvPart::Scale)) => 2,
        Target::Material(MaterialPart::Factor(Factor::BaseColor)) => 4,
        Target::Material(MaterialPart::Factor(
            Factor::Emissive
            | Factor::SpecularColor
            | Factor::SheenColor
            | Factor::AttenuationColor,
        )) => 3,
        _ => 1,
    }
}
