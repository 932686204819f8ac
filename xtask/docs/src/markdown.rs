//! A page's Markdown as HTML: headings can be linked to, links lead to pages of the site or to files of the repository,
//! and blocks of code are kept, so that they can be run.

use crate::error::{Error, Result};
use crate::page::{Page, escaped, page_of, to_top};
use pulldown_cmark::{CodeBlockKind, Event, HeadingLevel, Options, Parser, Tag, TagEnd, html};
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// Address of the repository.
const REPOSITORY: &str = env!("CARGO_PKG_REPOSITORY");

/// Addresses that pages name as `address:NAME`, from that of the repository.
const ADDRESSES: [(&str, &str); 2] =
    [("repository", REPOSITORY), ("downloads", concat!(env!("CARGO_PKG_REPOSITORY"), "/releases"))];

/// Place of the page for browsers, `address:page`, on the site, where it is built in, and else the page about it.
pub const APP: &str = "app/index.html";

/// Folder of the pictures.
pub const PICTURES: &str = "pictures";

const ABOUT_APP: &str = "web/page.html";

/// Surroundings of a page.
#[derive(Clone, Copy, Debug)]
pub struct Site<'a> {
    /// The repository.
    pub root: &'a Path,
    /// True where the page for browsers is a part of the site.
    pub has_app: bool,
}

/// A page as HTML.
#[derive(Debug, Default)]
pub struct Rendered {
    /// Content within the frame of the page.
    pub html: String,
    /// Headings of the second level and the names by which they are linked to.
    pub headings: Vec<(String, String)>,
    /// Blocks of code in their order.
    pub blocks: Vec<Block>,
    /// Pictures that the page's commands make.
    pub made: Vec<String>,
    /// Pictures of the repository that the page shows.
    pub copied: Vec<String>,
}

/// A block of code.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// Language, then words about what is done with it.
    info: String,
    /// The text.
    pub text: String,
}

impl Block {
    /// True where it holds commands.
    pub fn is_shell(&self) -> bool {
        self.info.split_whitespace().next().is_some_and(|language| language == "sh")
    }

    /// Commands that nobody but a person can run.
    pub fn is_by_hand(&self) -> bool {
        self.info.split_whitespace().any(|word| word == "by-hand")
    }

    /// Commands whose `python` has Blender as a module.
    pub fn needs_blender(&self) -> bool {
        self.info.split_whitespace().any(|word| word == "blender")
    }

    /// The file that it is.
    pub fn file(&self) -> Option<&str> {
        self.info.split_whitespace().find_map(|word| word.strip_prefix("file="))
    }
}

/// Renders a page.
///
/// # Errors
/// [`Error::Page`] for links that lead to no file of the repository.
pub fn render(page: &Page, site: Site<'_>) -> Result<Rendered> {
    let options = Options::ENABLE_TABLES | Options::ENABLE_STRIKETHROUGH;
    let mut rendered = Rendered::default();
    let mut names = BTreeMap::new();
    let mut events: Vec<Event<'_>> = Vec::new();
    // Where a heading or a block of code began.
    let mut opened = 0;
    for event in Parser::new_ext(&page.text, options) {
        match event {
            Event::Start(Tag::Link { link_type, dest_url, title, id }) => {
                let dest_url = target(&dest_url, page, site)?.into();
                events.push(Event::Start(Tag::Link { link_type, dest_url, title, id }));
            }
            Event::Start(Tag::Image { link_type, dest_url, title, id }) => {
                let dest_url = picture(&dest_url, page, &mut rendered).into();
                events.push(Event::Start(Tag::Image { link_type, dest_url, title, id }));
            }
            Event::Start(Tag::Heading { .. } | Tag::CodeBlock(_)) => {
                opened = events.len();
                events.push(event);
            }
            Event::End(TagEnd::Heading(level)) => {
                let text = plain(&events[opened..]);
                let id = unique(slug(&text), &mut names);
                events[opened] = heading(level, &id);
                if level == HeadingLevel::H2 {
                    rendered.headings.push((text, id));
                }
                events.push(Event::End(TagEnd::Heading(level)));
            }
            Event::End(TagEnd::CodeBlock) => {
                let block = block(&events[opened..]);
                let shown = shown(&block);
                events.truncate(opened);
                events.push(Event::Html(shown.into()));
                rendered.blocks.push(block);
            }
            other => events.push(other),
        }
    }
    html::push_html(&mut rendered.html, events.into_iter());
    rendered.html = rendered.html.replace("<table>", "<div class=\"table\"><table>");
    rendered.html = rendered.html.replace("</table>", "</table></div>");
    Ok(rendered)
}

fn heading(level: HeadingLevel, id: &str) -> Event<'static> {
    Event::Start(Tag::Heading { level, id: Some(id.to_owned().into()), classes: vec![], attrs: vec![] })
}

fn plain(events: &[Event<'_>]) -> String {
    let text = events.iter().filter_map(|event| match event {
        Event::Text(text) | Event::Code(text) => Some(text.as_ref()),
        _ => None,
    });
    text.collect()
}

fn block(events: &[Event<'_>]) -> Block {
    let info = match events.first() {
        Some(Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(info)))) => info.to_string(),
        _ => String::new(),
    };
    Block { info, text: plain(events) }
}

fn shown(block: &Block) -> String {
    let named = block.file().map(|name| format!("<figcaption>{}</figcaption>", escaped(name)));
    format!(
        "<figure class=\"code\">{}<pre><code>{}</code></pre></figure>\n",
        named.unwrap_or_default(),
        escaped(&block.text)
    )
}

/// The name that GitHub gives a heading, so that links hold there, too.
fn slug(text: &str) -> String {
    let kept = text.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

/// The same, told from headings above.
fn unique(slug: String, names: &mut BTreeMap<String, u32>) -> String {
    let count = names.entry(slug.clone()).or_insert(0);
    *count += 1;
    if *count == 1 { slug } else { format!("{slug}-{}", *count - 1) }
}

/// Target of a link of the Markdown on the site.
fn target(link: &str, page: &Page, site: Site<'_>) -> Result<String> {
    let is_outside = link.contains("://") || link.starts_with("mailto:") || link.starts_with('#');
    if is_outside {
        return Ok(link.to_owned());
    }
    if let Some(name) = link.strip_prefix("address:") {
        let place = if site.has_app { APP } else { ABOUT_APP };
        let page = (name == "page").then(|| format!("{}{place}", to_top(&page.path)));
        let known =
            ADDRESSES.iter().find(|(known, _)| *known == name).map(|(_, address)| (*address).to_owned());
        return page.or(known).ok_or_else(|| Error::page(name, "is no address that pages know"));
    }
    let (path, anchor) = link.split_once('#').map_or((link, String::new()), |(p, a)| (p, format!("#{a}")));
    let file = match (path.strip_prefix("repo:"), page.document) {
        (Some(file), _) => file.to_owned(),
        (None, Some(document)) => joined(Path::new(document).parent(), path),
        (None, None) => return Ok(format!("{}{anchor}", path.replace(".md", ".html"))),
    };
    if let Some(place) = page_of(&file) {
        return Ok(format!("{}{place}.html{anchor}", to_top(&page.path)));
    }
    if !site.root.join(&file).exists() {
        return Err(Error::page(&page.path, format!("the repository has no {file}, which {link} names")));
    }
    Ok(format!("{REPOSITORY}/blob/main/{file}{anchor}"))
}

/// A path of the repository from that of another, with `..` taken out.
fn joined(folder: Option<&Path>, path: &str) -> String {
    let mut whole = PathBuf::new();
    for part in folder.unwrap_or(Path::new("")).join(path).components() {
        match part {
            Component::ParentDir => drop(whole.pop()),
            part => whole.push(part),
        }
    }
    whole.to_string_lossy().replace('\\', "/")
}

/// Place of a picture on the site. `made:NAME` is one that the commands of the page have made, `repo:PATH` one of the
/// repository.
fn picture(link: &str, page: &Page, rendered: &mut Rendered) -> String {
    let top = to_top(&page.path);
    if let Some(name) = link.strip_prefix("made:") {
        rendered.made.push(name.to_owned());
        return format!("{top}{}", place_of_made(page, name));
    }
    let Some(file) = link.strip_prefix("repo:") else { return link.to_owned() };
    rendered.copied.push(file.to_owned());
    format!("{top}{}", place_of_copied(file))
}

/// Place where a picture of the repository is kept.
pub fn place_of_copied(file: &str) -> String {
    format!("{PICTURES}/{}", file.rsplit('/').next().unwrap_or(file))
}

/// Place where a picture that commands have made is kept.
pub fn place_of_made(page: &Page, name: &str) -> String {
    format!("{PICTURES}/{}-{}.jpg", page.path.replace('/', "-"), name.replace(['/', '.'], "-"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(text: &str, document: Option<&'static str>) -> Page {
        let (path, title) = ("a/b".to_owned(), "B".to_owned());
        Page { path, title, part: "", text: text.to_owned(), document }
    }

    fn site() -> Site<'static> {
        Site { root: Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")), has_app: false }
    }

    #[test]
    fn headings_are_named_as_on_github() {
        let text = "# Bytes on `x_y`, twice: A/B\n## Same\n## Same\n";
        let rendered = render(&page(text, None), site()).unwrap();
        assert!(rendered.html.contains("<h1 id=\"bytes-on-x_y-twice-ab\">"), "{}", rendered.html);
        let ids: Vec<&str> = rendered.headings.iter().map(|(_, id)| id.as_str()).collect();
        assert_eq!(ids, ["same", "same-1"]);
    }

    #[test]
    fn links_lead_to_pages_and_to_the_repository() {
        let of = |link: &str, document| {
            render(&page(&format!("[x]({link})"), document), site()).map(|rendered| rendered.html)
        };
        for (link, document, expected) in [
            ("../c.md#d", None, "href=\"../c.html#d\""),
            ("#d", None, "href=\"#d\""),
            ("https://a.org/b", None, "href=\"https://a.org/b\""),
            ("address:downloads", None, concat!("href=\"", env!("CARGO_PKG_REPOSITORY"), "/releases\"")),
            ("address:page", None, "href=\"../web/page.html\""),
            ("repo:include/isophote.h", None, "/blob/main/include/isophote.h\""),
            ("repo:CONTRIBUTING.md", None, "href=\"../contributors/contributing.html\""),
            ("README.md#nodes", Some("CONTRIBUTING.md"), "/blob/main/README.md#nodes\""),
            (
                "../../CONTRIBUTING.md",
                Some("nodes/plugin/OPENFX.md"),
                "href=\"../contributors/contributing.html\"",
            ),
        ] {
            let html = of(link, document).unwrap();
            assert!(html.contains(expected), "{link}: {html}");
        }
        assert!(of("repo:no/such/file", None).is_err() && of("address:moon", None).is_err());
        let with_app = Site { has_app: true, ..site() };
        let rendered = render(&page("[x](address:page)", None), with_app).unwrap();
        assert!(rendered.html.contains("href=\"../app/index.html\""), "{}", rendered.html);
    }

    #[test]
    fn blocks_are_kept_with_what_is_said_of_them() {
        let text = "```sh\na | b\n```\n\n```sh by-hand\nc\n```\n\n```json file=x.json\n{}\n```\n\n![p](made:out.png)\n";
        let rendered = render(&page(text, None), site()).unwrap();
        let [run, hand, file] = rendered.blocks.as_slice() else { panic!("{:?}", rendered.blocks) };
        assert!(run.is_shell() && !run.is_by_hand() && run.text == "a | b\n");
        assert!(hand.is_shell() && hand.is_by_hand());
        assert!(!file.is_shell() && file.file() == Some("x.json"));
        assert_eq!(rendered.made, ["out.png"]);
        assert!(rendered.html.contains("src=\"../pictures/a-b-out-png.jpg\""), "{}", rendered.html);
    }
}
