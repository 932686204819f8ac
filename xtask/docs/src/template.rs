//! The frame of a page: contents beside it, no script, nothing from elsewhere.

use crate::markdown::Rendered;
use crate::page::{PARTS, Page, escaped, to_top};
use std::fmt::Write as _;

/// The style sheet of all pages.
pub const STYLES: &str = include_str!("site.css");

/// A whole page.
pub fn framed(page: &Page, rendered: &Rendered, pages: &[Page]) -> String {
    let top = to_top(&page.path);
    let title = if page.path == "index" { page.title.clone() } else { format!("{} · Isophote", page.title) };
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{}</title>\n<link rel=\"stylesheet\" href=\"{top}site.css\">\n</head>\n<body>\n\
         <nav>\n{}</nav>\n<main>\n{}{}</main>\n</body>\n</html>\n",
        escaped(&title),
        contents(page, pages, &top),
        on_this_page(rendered),
        rendered.html
    )
}

/// All pages, the part of the one that is shown open.
fn contents(shown: &Page, pages: &[Page], top: &str) -> String {
    let mut html = format!("<a class=\"home\" href=\"{top}index.html\">Isophote</a>\n");
    let link = |page: &Page| {
        let is_shown = if page.path == shown.path { " aria-current=\"page\"" } else { "" };
        format!("<li><a href=\"{top}{}.html\"{is_shown}>{}</a></li>\n", page.path, escaped(&page.title))
    };
    let links = |part: &str| -> String {
        pages.iter().filter(|page| page.part == part && page.path != "index").map(link).collect()
    };
    let _ = writeln!(html, "<ul>\n{}</ul>", links(""));
    for part in PARTS.iter().filter(|part| !part.is_empty()) {
        let is_open = if shown.part == *part { " open" } else { "" };
        let _ =
            writeln!(html, "<details{is_open}><summary>{part}</summary><ul>\n{}</ul></details>", links(part));
    }
    html
}

/// Headings of a long page.
fn on_this_page(rendered: &Rendered) -> String {
    if rendered.headings.len() < 4 {
        return String::new();
    }
    let links = rendered.headings.iter().map(|(text, id)| format!("<a href=\"#{id}\">{}</a>", escaped(text)));
    format!("<p class=\"headings\">{}</p>\n", links.collect::<Vec<_>>().join(" · "))
}
