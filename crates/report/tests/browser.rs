//! The page in a real browser: every picture is there, nothing is loaded, nothing complains.
//! Needs Chromium; where there is none the test says so and passes.
//! (`SPHCUT_PICTURES=folder cargo test -p sphcut-report` keeps the page and a screenshot.)

use sphcut_postprocess::evaluate;
use sphcut_postprocess::synthetic::SyntheticCut;
use sphcut_report::{render_report, write_report};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn page() -> String {
    let run = SyntheticCut::default().run(1.6e-3, 17);
    render_report(&run, &evaluate(&run).unwrap()).unwrap()
}

/// A fresh folder below the build's own for temporary files.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn chromium() -> Option<&'static str> {
    ["chromium", "chromium-browser", "google-chrome"].into_iter().find(|name| {
        let version = Command::new(name)
            .arg("--version")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        version.is_ok_and(|status| status.success())
    })
}

fn browse(browser: &str, folder: &Path, page: &Path, what: &[&str]) -> Output {
    let mut command = Command::new("timeout");
    command.arg("120").arg(browser).args([
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-quic",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--disable-dev-shm-usage",
        "--enable-logging=stderr",
        "--virtual-time-budget=5000",
    ]);
    command.arg(format!("--user-data-dir={}", folder.join("profile").display()));
    command.args(what).arg(format!("file://{}", page.display()));
    command.output().unwrap()
}

#[test]
fn the_page_shows_every_picture_and_has_no_errors_in_a_browser() {
    let Some(browser) = chromium() else {
        println!("skipped: no Chromium on this machine");
        return;
    };
    let folder = folder("browser");
    // The copy under test counts its pictures once everything is loaded.
    let probe = "<script>window.addEventListener('load', () => {
        const images = [...document.images];
        const shown = images.filter(i => i.complete && i.naturalWidth > 200 && i.alt.length > 20);
        const charts = [...document.querySelectorAll('svg.chart')]
            .filter(c => c.getBoundingClientRect().height > 100);
        const wide = document.documentElement.scrollWidth > window.innerWidth;
        document.body.dataset.probe =
            `${shown.length}/${images.length} images, ${charts.length} charts, overflow ${wide}`;
    });</script></body>";
    let probed = folder.join("probed.html");
    std::fs::write(&probed, page().replace("</body>", probe)).unwrap();
    let output = browse(browser, &folder, &probed, &["--window-size=1280,900", "--dump-dom"]);
    let document = String::from_utf8_lossy(&output.stdout);
    let log = String::from_utf8_lossy(&output.stderr);
    assert!(
        document.contains("9/9 images, 9 charts, overflow false"),
        "{:?}\n{log}",
        document.find("data-probe").map(|at| &document[at..at + 80])
    );
    let complaints: Vec<&str> = log.lines().filter(|line| line.contains("CONSOLE")).collect();
    assert!(complaints.is_empty(), "{complaints:?}");
}

#[test]
fn the_page_loads_nothing_and_escapes_what_it_is_given() {
    let page = page();
    for attribute in ["src=\"", "href=\"", "srcset=\""] {
        for part in page.split(attribute).skip(1) {
            assert!(part.starts_with("data:"), "{}", &part[..60.min(part.len())]);
        }
    }
    assert!(!page.contains("url(") && !page.contains("@import"));
    assert!(page.contains("A cut drawn by hand &lt;&amp;&gt;"));
    assert!(!page.contains("hand <&>"));
    for text in ["Before you use these numbers", "How to reproduce", "sphcut run drawn.toml"] {
        assert!(page.contains(text), "{text}");
    }
    for text in ["Shear angle", "Strain rate in it", "Sticking part", "the chip is continuous"] {
        assert!(page.contains(text), "{text}");
    }
    for (_, _, title) in sphcut_postprocess::ENERGY_TERMS {
        assert!(page.contains(title), "{title}");
    }
}

#[test]
fn the_scenario_can_do_without_pictures_or_without_the_animation() {
    let mut run = SyntheticCut::default().run(0.4e-3, 3);
    let result = evaluate(&run).unwrap();
    for (key, gifs, pngs) in [("animation", 0, 8), ("pictures", 0, 0)] {
        run.provenance.settings = vec![sphcut_record::Setting {
            section: "output".to_owned(),
            key: key.to_owned(),
            text: "false".to_owned(),
            ..Default::default()
        }];
        let page = render_report(&run, &result).unwrap();
        let count = |kind: &str| page.matches(&format!("data:image/{kind}")).count();
        assert_eq!((count("gif"), count("png")), (gifs, pngs), "{key}");
    }
}

#[test]
fn a_run_with_nothing_in_it_has_a_page_too() {
    let mut run = SyntheticCut::default().run(0.0, 0);
    run.facts.tool_velocity = None;
    run.facts.uncut_chip_thickness = None;
    let folder = folder("empty");
    let result = evaluate(&run).unwrap();
    let path = write_report(&run, &result, &folder).unwrap();
    assert!(std::fs::read_to_string(path).unwrap().contains("How to reproduce"));
    let missing = folder.join("missing");
    let error = write_report(&run, &result, &missing).unwrap_err().to_string();
    assert!(error.contains("report.html"), "{error}");
}

#[test]
fn the_page_can_be_looked_at() {
    let Ok(kept) = std::env::var("SPHCUT_PICTURES") else { return };
    let kept = PathBuf::from(kept);
    let report = kept.join("report.html");
    std::fs::write(&report, page()).unwrap();
    let Some(browser) = chromium() else { return };
    let screenshot = format!("--screenshot={}", kept.join("report.png").display());
    let profile = folder("screenshot");
    browse(browser, &profile, &report, &["--window-size=1240,7600", &screenshot]);
    assert!(kept.join("report.png").exists());
}
