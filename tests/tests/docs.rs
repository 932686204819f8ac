//! The documentation as a site: made with small pictures, which runs every command that stands on it and follows every
//! link; and a page that is wrong is named.

#![cfg(target_os = "linux")]

use isophote::registry;
use isophote_tests::library;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// The folder of the build under test.
fn built() -> &'static Path {
    library::path().parent().unwrap()
}

/// The chores' program makes the site.
fn docs(out: &Path, page: &Path) -> Output {
    let mut docs = Command::new(built().join("xtask"));
    docs.arg("docs").arg("--out").arg(out).args(["--size", "96x64", "--frames", "2"]).arg("--page").arg(page);
    docs.env("CARGO_TARGET_DIR", built().parent().unwrap()).current_dir(library::root());
    docs.output().unwrap()
}

fn said(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

#[test]
fn the_site_is_made_and_all_its_commands_run() {
    let folder = TempDir::new().unwrap();
    let site = folder.path().join("site");
    let app = folder.path().join("app.html");
    std::fs::write(&app, "<script>1</script>").unwrap();
    let output = docs(&site, &app);
    std::fs::remove_file(app).unwrap();
    let said = said(&output);
    assert!(output.status.success(), "{said}");
    let line = said.lines().find(|line| line.contains("blocks of commands run")).unwrap();
    println!("{line}");
    let number = |before: &str| {
        let words = line.split_once(before).unwrap().0.split_whitespace().next_back().unwrap();
        words.parse::<usize>().unwrap()
    };
    assert!(number(" blocks of commands run") >= 30 && number(" links followed") > 1000, "{line}");

    let page = |path: &str| std::fs::read_to_string(site.join(path)).unwrap();
    for node in registry::nodes() {
        let reference = page(&format!("nodes/{}.html", node.id));
        assert!(node.params().all(|p| reference.contains(&format!("<code>{}</code>", p.id))), "{}", node.id);
        if node.group == "styles" {
            let style = page(&format!("styles/{}.html", node.id));
            let looks = node.params().filter(|p| p.group == "look" && p.id != "cover");
            // Before and after, and each control at two values or more.
            assert!(style.matches("<img ").count() >= 2 + 2 * looks.count(), "{}", node.id);
        }
    }
    controls_do_something(&site);
    looks_are_shown_on_both_subjects(&site);
    let start = page("index.html");
    assert!(start.contains("href=\"app/index.html\"") && site.join("app/index.html").is_file());
    // Each moves, is small, and stands beside a still for those who want less motion.
    assert!(start.matches(".webp\"").count() >= 3, "{start}");
    assert_eq!(start.matches(".webp\"").count(), start.matches("(prefers-reduced-motion: reduce)").count());
    for file in std::fs::read_dir(site.join("pictures")).unwrap().map(|entry| entry.unwrap().path()) {
        if file.extension().is_some_and(|e| e == "webp") {
            let bytes = std::fs::read(&file).unwrap();
            assert!(bytes.windows(4).filter(|part| part == b"ANMF").count() == 2, "{}", file.display());
        }
    }
    // Made under another name, which is gone.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// The pictures at both ends of a control differ, but for controls of what the scene does not have.
fn controls_do_something(site: &Path) {
    let picture = |node: &str, param: &str, number: usize| -> PathBuf {
        site.join(format!("pictures/style-{node}-{param}-{number}.jpg"))
    };
    let (mut same, mut all) = (Vec::new(), 0);
    for node in registry::nodes().iter().filter(|node| node.group == "styles") {
        for param in node.params().filter(|p| p.group == "look" && p.id != "cover") {
            let last = (1..).take_while(|n| picture(node.id, param.id, *n).exists()).last().unwrap();
            let [low, high] = [0, last].map(|n| std::fs::read(picture(node.id, param.id, n)).unwrap());
            all += 1;
            if low == high {
                same.push(format!("{}.{}", node.id, param.id));
            }
        }
    }
    assert!(all > 60 && same.is_empty(), "pictures of these controls show nothing: {same:?}");
}

/// Every look has a picture of the scene and one of the photograph, which differ.
fn looks_are_shown_on_both_subjects(site: &Path) {
    let page = std::fs::read_to_string(site.join("artists/looks.html")).unwrap();
    for look in isophote::preset::LOOKS {
        let pictures = ["scene", "photo"].map(|subject| format!("pictures/look-{}-{subject}.jpg", look.id));
        assert!(pictures.iter().all(|picture| page.contains(picture)), "{}", look.id);
        let [scene, photo] = pictures.map(|picture| std::fs::read(site.join(picture)).unwrap());
        assert!(scene != photo, "{}", look.id);
    }
}

/// A copy of the pages with one of them changed.
fn pages_with(folder: &Path, page: &str, text: &str) -> PathBuf {
    fn copy(from: &Path, to: &Path) {
        std::fs::create_dir_all(to).unwrap();
        for entry in std::fs::read_dir(from).unwrap().map(Result::unwrap) {
            let target = to.join(entry.file_name());
            if entry.path().is_dir() {
                copy(&entry.path(), &target);
            } else {
                std::fs::copy(entry.path(), target).unwrap();
            }
        }
    }
    let pages = folder.join("pages");
    copy(&library::root().join("xtask/docs/pages"), &pages);
    std::fs::write(pages.join(page), text).unwrap();
    pages
}

#[test]
fn a_page_that_is_wrong_is_named_and_the_old_site_stays() {
    let around = TempDir::new().unwrap();
    let (scene, none) = (around.path().join("scene"), around.path().join("none"));
    std::fs::create_dir(&none).unwrap();
    let made = Command::new(built().join("isophote-demo-scene")).arg(&scene).output().unwrap();
    assert!(made.status.success(), "{}", said(&made));
    for (text, named) in [
        ("# A\n\n```sh\nisophote apply cartoon absent.png out.png\n```\n", "absent.png"),
        ("# A\n\n[gone](repo:no/such/file.md)\n", "the repository has no no/such/file.md"),
        ("# A\n\n![picture](made:out.png)\n", "its commands do not make"),
    ] {
        let folder = TempDir::new().unwrap();
        let site = folder.path().join("site");
        std::fs::create_dir(&site).unwrap();
        std::fs::write(site.join("old.html"), "old").unwrap();
        // The first page of the contents, so that the others are not run before.
        let pages = pages_with(folder.path(), "index.md", text);
        // What the chore starts, without packages, which the first page does not need.
        let mut docs = Command::new(built().join("isophote-docs"));
        docs.arg("--host").arg(built().join("isophote")).arg("--library").arg(library::path());
        docs.arg("--scene").arg(scene.join("city.gltf")).arg("--pages").arg(&pages).arg("--out").arg(&site);
        docs.arg("--packages").arg(&none).arg("--wheels").arg(&none);
        let output = docs.output().unwrap();
        let said = said(&output);
        assert!(!output.status.success() && said.contains(named) && said.contains("index"), "{text}: {said}");
        assert!(site.join("old.html").exists());
    }
}
