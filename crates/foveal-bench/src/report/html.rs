//! Figures of the page. Every one goes through [`Figures::figure`], which takes it out of the JSON
//! and leaves its place there in the markup, so that a test can look each of them up.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde_json::Value;

/// The JSON that the page is made from.
pub(super) struct Figures<'a>(pub(super) &'a Value);

impl Figures<'_> {
    /// The number at a JSON pointer, or a dash where there is none.
    pub(super) fn figure(&self, pointer: &str, factor: f64, digits: usize) -> Markup {
        html! {
            @match self.shown(pointer, factor, digits) {
                Some(text) => span data-json=(pointer) data-factor=(factor) data-digits=(digits) { (text) },
                None => "\u{2013}",
            }
        }
    }

    /// As [`Figures::figure`], for the inside of an SVG.
    pub(super) fn svg_figure(&self, pointer: &str, factor: f64, digits: usize) -> Markup {
        html! {
            @if let Some(text) = self.shown(pointer, factor, digits) {
                tspan data-json=(pointer) data-factor=(factor) data-digits=(digits) { (text) }
            }
        }
    }

    fn shown(&self, pointer: &str, factor: f64, digits: usize) -> Option<String> {
        match self.0.pointer(pointer)? {
            Value::Number(number) => Some(rounded(number.as_f64()? * factor, digits)),
            Value::String(text) => Some(text.clone()),
            _ => None,
        }
    }

    /// A text of the JSON's; empty where there is none.
    pub(super) fn text(&self, pointer: &str) -> &str {
        let text = self.0.pointer(pointer).and_then(Value::as_str);
        text.unwrap_or_default()
    }

    /// A text or a number of the JSON's, as the JSON has it.
    pub(super) fn word(&self, pointer: &str) -> String {
        match self.0.pointer(pointer) {
            Some(Value::String(text)) => text.clone(),
            Some(Value::Number(number)) => number.to_string(),
            _ => String::new(),
        }
    }

    /// The number at a pointer.
    pub(super) fn number(&self, pointer: &str) -> Option<f64> {
        self.0.pointer(pointer)?.as_f64()
    }

    /// How many entries the array at a pointer has.
    pub(super) fn len(&self, pointer: &str) -> usize {
        let array = self.0.pointer(pointer).and_then(Value::as_array);
        array.map_or(0, Vec::len)
    }
}

/// As the page spells numbers.
pub(super) fn rounded(number: f64, digits: usize) -> String {
    format!("{number:.digits$}")
}

/// A whole page without network: a title, a body, a script, and style beyond that of all pages.
pub(super) fn page(title: &str, style: &str, body: &Markup, script: Option<&str>) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                link rel="icon" href="data:,";
                style { (PreEscaped(STYLE)) (PreEscaped(style)) }
            }
            body {
                main { (body) }
                @if let Some(script) = script {
                    script { (PreEscaped(script)) }
                }
            }
        }
    };
    page.into_string() + "\n"
}

const STYLE: &str = "
:root { color-scheme: light dark; --back: #fbfbfc; --card: #fff; --line: #dfe3e8; --text: #1c2026; --faint: #626b78;
  --accent: #1f6fb4; --bad: #b3382c; --good: #1d7a3a; --pay: #8a5a00; }
@media (prefers-color-scheme: dark) { :root { --back: #14161a; --card: #1d2026; --line: #343a44; --text: #dce0e6;
  --faint: #97a0ad; --accent: #6cb6ff; --bad: #ff7b72; --good: #6fd08c; --pay: #e6b450; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--back); color: var(--text); font: 15px/1.5 system-ui, sans-serif; }
main { max-width: 1080px; margin: 0 auto; padding: 24px 16px 64px; }
h1 { font-size: 28px; margin: 0 0 4px; } h2 { font-size: 21px; margin: 0 0 4px; } h3 { font-size: 15px; margin: 20px 0 6px; }
p { margin: 4px 0 10px; } .faint { color: var(--faint); } .bad { color: var(--bad); font-weight: 600; }
section { background: var(--card); border: 1px solid var(--line); border-radius: 10px; padding: 18px; margin: 18px 0; }
nav { display: flex; flex-wrap: wrap; gap: 8px; margin: 14px 0; }
nav a { color: var(--text); text-decoration: none; border: 1px solid var(--line); border-radius: 99px; padding: 3px 12px;
  background: var(--card); } nav a.off { color: var(--faint); }
.scroll { overflow-x: auto; } table { border-collapse: collapse; font-variant-numeric: tabular-nums; min-width: 100%; }
th, td { text-align: right; padding: 4px 8px; border-bottom: 1px solid var(--line); white-space: nowrap; }
th:first-child, td:first-child { text-align: left; white-space: normal; min-width: 9em; position: sticky; left: 0;
  background: var(--card); } td { vertical-align: top; } small { color: var(--faint); } th { color: var(--faint); font-weight: 600; }
code { font: 13px ui-monospace, monospace; overflow-wrap: anywhere; background: var(--back); border-radius: 4px; padding: 1px 5px; }
.columns, .pair { display: grid; gap: 18px; } .columns { grid-template-columns: repeat(auto-fill, minmax(min(300px, 100%), 1fr)); }
.columns h3, .pair h3 { margin-top: 6px; }
.pair { grid-template-columns: repeat(auto-fit, minmax(min(400px, 100%), 1fr)); }
.compare { position: relative; display: grid; overflow: hidden; border-radius: 6px; touch-action: pan-y; }
.compare img { grid-area: 1 / 1; width: 100%; display: block; }
.compare .after { clip-path: inset(0 0 0 var(--at, 50%)); }
.compare .line { position: absolute; top: 0; bottom: 0; left: var(--at, 50%); width: 2px; background: #fff; box-shadow: 0 0 4px #000; }
.compare span { position: absolute; top: 8px; padding: 1px 8px; border-radius: 4px; background: #000a; color: #fff; font-size: 13px; }
.compare .left { left: 8px; } .compare .right { right: 8px; }
input[type=range] { width: 100%; margin: 8px 0 0; } figure { margin: 12px 0; } figcaption { color: var(--faint); }
.difference { width: 100%; border-radius: 6px; display: block; } svg { width: 100%; max-width: 480px; height: auto; display: block; }
svg .grid { stroke: var(--line); } svg .one { stroke: var(--faint); } svg .error { stroke-width: 1.5; opacity: 0.75; }
svg .faster { color: var(--good); } svg .slower { color: var(--bad); } svg .no-difference, svg .too-few { color: var(--faint); }
.verdicts p { display: grid; grid-template-columns: 6.5em 1fr; gap: 8px; margin: 8px 0; }
.adopt > b, .better-as-fast > b { color: var(--good); } .faster-but-visible > b, .better-but-slower > b { color: var(--pay); } .skip > b, .impossible > b { color: var(--faint); }
.copy { display: flex; gap: 8px; align-items: flex-start; } .copy code { flex: 1; padding: 6px 8px; } button { font: inherit;
  color: var(--text); background: var(--back); border: 1px solid var(--line); border-radius: 6px; padding: 3px 12px; cursor: pointer; }
summary { cursor: pointer; color: var(--accent); margin: 10px 0 4px; }
@media (max-width: 480px) { section { padding: 14px 10px; } .verdicts p { grid-template-columns: 1fr; gap: 0; } }
@media print { :root { --back: #fff; --card: #fff; --line: #ccc; --text: #000; --faint: #444; } nav, button, input { display: none; }
  section { break-inside: avoid; border: none; padding: 0; } .scroll { overflow: visible; } main { max-width: none; padding: 0; } }
svg text { fill: var(--text); font: 12px system-ui, sans-serif; } svg .faint { fill: var(--faint); }
";

/// The slider; the page works without it, half and half.
pub(super) const SCRIPT: &str = "
for (const slider of document.querySelectorAll('input[type=range]')) {
  const compare = slider.previousElementSibling;
  slider.addEventListener('input', () => compare.style.setProperty('--at', slider.value + '%'));
}
for (const button of document.querySelectorAll('.copy button')) {
  button.addEventListener('click', async () => {
    await navigator.clipboard.writeText(button.previousElementSibling.textContent);
    button.textContent = 'Copied';
  });
}
addEventListener('beforeprint', () => document.querySelectorAll('details').forEach((fold) => { fold.open = true; }));
document.documentElement.dataset.ready = 'yes';
";
