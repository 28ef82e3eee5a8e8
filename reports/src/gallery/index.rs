//! The index of the gallery: a card with thumbnail, title, commands and scene for each entry.

use super::Card;
use super::drawn::Drawn;
use super::entries::{Entry, Section};
use std::fmt::Write;

const TEMPLATE: &str = include_str!("index.html");

/// Returns the index of the gallery as HTML.
pub(super) fn index(cards: &[Card]) -> String {
    let mut content = String::new();
    for section in Section::ALL {
        let of_section = cards.iter().filter(|card| card.entry.section == section);
        let drawn = of_section.filter_map(|card| Some((card.entry, card.drawn.as_ref().ok()?)));
        let drawn: String = drawn.map(|(entry, drawn)| article(entry, drawn)).collect();
        if !drawn.is_empty() {
            let title = section.title();
            let _ = writeln!(content, "<h2>{title}</h2>\n<div class=\"cards\">\n{drawn}</div>");
        }
    }
    let failed = cards.iter().filter_map(|card| Some((card.entry, card.drawn.as_ref().err()?)));
    let failed: String = failed
        .map(|(entry, cause)| {
            format!("<li>{}: {}</li>\n", escaped(&entry.name), escaped(&cause.to_string()))
        })
        .collect();
    if !failed.is_empty() {
        let _ = writeln!(content, "<h2>Not drawn</h2>\n<ul id=\"failed\">\n{failed}</ul>");
    }
    TEMPLATE.replacen("{{content}}", &content, 1)
}

/// Returns the card of an entry.
fn article(entry: &Entry, drawn: &Drawn) -> String {
    let Drawn { title, summary, scene, commands, notes, .. } = drawn;
    let (name, title) = (escaped(&entry.name), escaped(title));
    let paragraph = |class: &str, text: &String| format!("<p{class}>{}</p>\n", escaped(text));
    let texts = summary.iter().map(|text| paragraph("", text));
    let texts: String =
        texts.chain(notes.iter().map(|note| paragraph(" class=\"note\"", note))).collect();
    // Lines are broken between words only, not at the hyphens of options.
    let word = |word: &str| format!("<span>{}</span>", escaped(word));
    let line = |command: &String| command.split(' ').map(word).collect::<Vec<_>>().join(" ");
    let commands = commands.iter().map(line).collect::<Vec<_>>().join("\n");
    let shown = format!("Scene (tangency show {})", escaped(entry.arguments));
    let scene = escaped(scene.trim_end());
    format!(
        "<article id=\"{name}\">
<a class=\"picture\" href=\"{name}.html\"><img src=\"{name}.svg\" alt=\"First panel of the figure: {title}\" loading=\"lazy\"></a>
<h3><a href=\"{name}.html\">{title}</a></h3>
{texts}<div class=\"last\"><pre class=\"command\">{commands}</pre>
<details><summary>{shown}</summary><pre>{scene}</pre></details></div>
</article>
"
    )
}

/// Escapes the special characters of HTML in a text.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
