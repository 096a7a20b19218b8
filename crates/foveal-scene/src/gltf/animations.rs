//! Animations: definitions, and their key frames as numbers.
//!
//! A channel that cannot be played is left out with a warning: the rest of the scene still moves.

use super::document::Counts;
use super::json::Obj;
use super::reader::Reader;
use crate::error::{Flaw, Parsed};
use crate::pose::{Animation, Channel, Interpolation, Target};
use crate::{Code, Warning};

struct SamplerDef {
    input: u32,
    output: u32,
    interpolation: Interpolation,
}

struct ChannelDef {
    sampler: u32,
    node: Option<u32>,
    path: String,
}

/// An animation as the file has it.
pub(crate) struct AnimationDef {
    name: Option<String>,
    samplers: Vec<SamplerDef>,
    channels: Vec<ChannelDef>,
}

impl AnimationDef {
    pub(crate) fn parse(o: Obj<'_>, counts: &Counts) -> Parsed<Self> {
        let samplers = o.objects("samplers", |s| {
            Ok(SamplerDef {
                input: s.need("input", s.index("input", counts.accessors)?)?,
                output: s.need("output", s.index("output", counts.accessors)?)?,
                interpolation: match s.string("interpolation")? {
                    None | Some("LINEAR") => Interpolation::Linear,
                    Some("STEP") => Interpolation::Step,
                    Some("CUBICSPLINE") => Interpolation::CubicSpline,
                    Some(other) => {
                        return Err(Flaw::new(
                            Code::ValueUnknown,
                            format!("\"{other}\" is not an interpolation"),
                        )
                        .under("interpolation"));
                    }
                },
            })
        })?;
        let channels = o.objects("channels", |c| {
            let target = c.need("target", c.object("target")?)?;
            let within = |e: Flaw| e.under("target");
            Ok(ChannelDef {
                sampler: c.need("sampler", c.index("sampler", samplers.len())?)?,
                node: target.index("node", counts.nodes).map_err(within)?,
                path: target
                    .need("path", target.string("path").map_err(within)?)
                    .map_err(within)?
                    .to_owned(),
            })
        })?;
        Ok(Self {
            name: o.name("name")?,
            samplers,
            channels,
        })
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
            match self.read_channel(def, reader, &weights_of) {
                Ok(Some(channel)) => {
                    let twin = |c: &Channel| c.node == channel.node && c.target == channel.target;
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
        let target = match def.path.as_str() {
            "translation" => Target::Translation,
            "rotation" => Target::Rotation,
            "scale" => Target::Scale,
            "weights" => Target::Weights,
            "pointer" => {
                return Err(Flaw::new(
                    Code::AnimationUnsupported,
                    "is a pointer (KHR_animation_pointer), which is not supported",
                )
                .under("target.path"));
            }
            other => {
                return Err(Flaw::new(
                    Code::AnimationUnsupported,
                    format!("\"{other}\" cannot be animated"),
                )
                .under("target.path"));
            }
        };
        // The specification lets channels without a node be ignored.
        let Some(node) = def.node else {
            return Ok(None);
        };
        let place = |e: Flaw, part: &str| e.under(format_args!("sampler {} {part}", def.sampler));
        let sampler = &self.samplers[def.sampler as usize];
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
            Target::Translation | Target::Scale => 3,
            Target::Rotation => 4,
            Target::Weights => weights_of(node),
        };
        let values: Vec<f32> = match target {
            Target::Translation | Target::Scale => reader
                .floats::<3>(sampler.output)
                .map(|v| v.into_flattened()),
            Target::Rotation => reader
                .floats::<4>(sampler.output)
                .map(|v| v.into_flattened()),
            Target::Weights => reader
                .floats::<1>(sampler.output)
                .map(|v| v.into_flattened()),
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
                "moves the weights of a node without morph targets",
            ));
        }
        if values.len() < needed || !values.iter().all(|v| v.is_finite()) {
            let cause = format!("has {} usable numbers instead of {needed}", values.len());
            return Err(place(Flaw::new(Code::Animation, cause), "output"));
        }
        Ok(Some(Channel {
            node,
            target,
            interpolation: sampler.interpolation,
            width,
            times,
            values,
        }))
    }
}
