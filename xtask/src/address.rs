//! Addresses of the project, all from `repository` of the workspace's manifest.

use crate::error::{Failure, Result};

/// Address of the repository.
pub const REPOSITORY: &str = env!("CARGO_PKG_REPOSITORY");

/// Place of the page for browsers on the site, where `.github/workflows/site.yml` has it.
const PAGE: &str = "app/";

/// Address of the site: that of GitHub Pages for a repository there.
///
/// # Errors
/// A repository that is elsewhere: where its site is cannot be told from it.
fn site(repository: &str) -> Result<String> {
    let place = repository.strip_prefix("https://github.com/").and_then(|path| path.split_once('/'));
    let (owner, name) = place.ok_or_else(|| {
        Failure(format!(
            "{repository} is no repository of GitHub: say in xtask/src/address.rs where its site is"
        ))
    })?;
    Ok(format!("https://{}.github.io/{name}/", owner.to_lowercase()))
}

/// Paragraph of the README that leads to downloads, the page, the documentation and the sources.
///
/// # Errors
/// A repository that is elsewhere than on GitHub.
pub fn paragraph() -> Result<String> {
    let site = site(REPOSITORY)?;
    Ok(format!(
        "**[Download]({REPOSITORY}/releases)** · **[Try it in your browser]({site}{PAGE})** · [Documentation]({site}) · \
         sources: `git clone {REPOSITORY}`\n"
    ))
}

/// A text with the address in the place of `@REPOSITORY@`.
pub fn filled(text: &str) -> String {
    text.replace("@REPOSITORY@", REPOSITORY)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sites_follow_from_repositories() {
        assert_eq!(site("https://github.com/Some/thing").unwrap(), "https://some.github.io/thing/");
        assert!(site("https://some.where/thing").is_err());
    }

    #[test]
    fn the_npm_package_names_the_repository() {
        let manifest = include_str!("../../nodes/web/package/package.json");
        assert!(filled(manifest).contains(&format!("git+{REPOSITORY}.git")));
    }
}
