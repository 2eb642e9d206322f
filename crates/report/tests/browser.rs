//! The page in a real browser: every picture is there, nothing is loaded, nothing complains.
//! Needs Chromium; where there is none the test says so and passes.
//! (`SPHCUT_PICTURES=folder cargo test -p sphcut-report` keeps the page and a screenshot.)

use sphcut_diagnose::{WearSegment, grows};
use sphcut_postprocess::evaluate;
use sphcut_postprocess::synthetic::SyntheticCut;
use sphcut_report::{WearPage, render_report, render_wear, write_report};
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

/// What `probe` leaves in `document.body.dataset.probe` once the page is loaded in a window of a width, and what
/// the browser complained of.
fn probed(
    browser: &str,
    (page, probe): (&str, &str),
    width: u32,
    scheme: &str,
) -> (String, String) {
    let folder = folder(&format!("browser_{width}_{scheme}_{}", probe.len()));
    let path = folder.join("probed.html");
    let script = format!(
        "<script>window.addEventListener('load', () => {{
            const folded = document.documentElement.scrollHeight;
            document.querySelectorAll('details').forEach(one => {{ one.open = true; }});
            {probe}
            parent.document.body.dataset.probe = document.body.dataset.probe;
        }});</script></body>"
    );
    std::fs::write(folder.join("page.html"), page.replace("</body>", &script)).unwrap();
    // A window of a browser is never narrower than 500 pixels; a frame is.
    let frame = format!(
        "<body><iframe src=page.html width={width} height=900 style='border: 0'></iframe></body>"
    );
    std::fs::write(&path, frame).unwrap();
    // 0 is dark, 1 is light.
    let scheme = format!("--blink-settings=preferredColorScheme={}", u8::from(scheme == "light"));
    let what = ["--window-size=1400,1000", "--allow-file-access-from-files", &scheme, "--dump-dom"];
    let output = browse(browser, &folder, &path, &what);
    let document = String::from_utf8_lossy(&output.stdout);
    let log = String::from_utf8_lossy(&output.stderr);
    let complaints: Vec<&str> = log.lines().filter(|line| line.contains("CONSOLE")).collect();
    let answer = document.split_once("data-probe=\"").and_then(|(_, rest)| rest.split_once('"'));
    (answer.unwrap_or_default().0.to_owned(), complaints.join("\n"))
}

#[test]
fn the_page_shows_every_picture_and_has_no_errors_in_a_browser() {
    let Some(browser) = chromium() else {
        println!("skipped: no Chromium on this machine");
        return;
    };
    let probe = "const images = [...document.images];
        const shown = images.filter(i => i.complete && i.naturalWidth > 200 && i.alt.length > 20);
        const charts = [...document.querySelectorAll('svg.chart')]
            .filter(c => c.getBoundingClientRect().height > 100);
        const wide = document.documentElement.scrollWidth > document.documentElement.clientWidth;
        const long = innerWidth > 1000 && folded > 4000;
        const dark = getComputedStyle(document.body).backgroundColor !== 'rgb(255, 255, 255)';
        document.body.dataset.probe =
            `${shown.length}/${images.length} images, ${charts.length} charts, overflow ${wide}, long ${long ? folded : false}, dark ${dark}`;";
    let page = page();
    for (width, scheme) in [(1300, "light"), (1300, "dark"), (390, "light"), (390, "dark")] {
        let (found, complaints) = probed(browser, (&page, probe), width, scheme);
        let dark = scheme == "dark";
        let expected = format!("9/9 images, 9 charts, overflow false, long false, dark {dark}");
        assert_eq!(found, expected, "{width} {scheme} {complaints}");
        assert_eq!(complaints, "", "{width} {scheme}");
    }
}

#[test]
fn the_animation_and_the_charts_follow_each_other_and_values_are_read_under_the_pointer() {
    let Some(browser) = chromium() else {
        println!("skipped: no Chromium on this machine");
        return;
    };
    let probe = "const find = what => document.querySelector(what);
        const state = () => [find('.animation img').src, +find('.moment').getAttribute('x1'), find('input[type=range]').value];
        const chart = find('svg.follows');
        const frame = chart.getBoundingClientRect();
        const point = (type, share, pointerType) => chart.dispatchEvent(new PointerEvent(type,
            { pointerType, bubbles: true, clientX: frame.left + share * frame.width, clientY: frame.top + 0.5 * frame.height }));
        const said = [];
        const [last, right, end] = state();
        said.push(`last ${end}`);
        const slider = find('input[type=range]');
        slider.value = 0;
        slider.dispatchEvent(new Event('input'));
        const [first, left] = state();
        said.push(`another picture ${first !== last}, mark from ${Math.round(right)} to ${Math.round(left)}`);
        point('click', 0.53);
        said.push(`click ${state()[2]}, ${find('output').textContent}`);
        const strain = find('input[value=plastic_strain]');
        const before = state()[0];
        strain.checked = true;
        strain.dispatchEvent(new Event('change'));
        said.push(`another field ${state()[0] !== before}: ${find('.span').textContent.split(' ').slice(0, 2).join(' ')}`);
        point('pointermove', 0.53);
        said.push(find('.readout').hidden ? 'nothing' : [...find('.readout').children].map(row => row.textContent).join('; '));
        point('pointermove', 0.999);
        said.push(`beside it hidden ${find('.readout').hidden}`);
        point('pointerdown', 0.53, 'touch');
        document.documentElement.dispatchEvent(new PointerEvent('pointerleave', { pointerType: 'touch' }));
        said.push(`after a touch hidden ${find('.readout').hidden}`);
        document.body.dataset.probe = said.join(' | ');";
    let (found, complaints) = probed(browser, (&page(), probe), 1300, "light");
    assert_eq!(complaints, "");
    let parts: Vec<&str> = found.split(" | ").collect();
    let [last, moved, click, field, values, beside, touch] = parts[..] else { panic!("{found}") };
    // Seventeen snapshots over 1.6 mm of travel.
    assert_eq!(last, "last 16");
    assert_eq!(moved, "another picture true, mark from 942 to 74");
    // The axis runs from 74 to 942 of 960: 0.53 is in its middle, 0.8 mm.
    assert!(click.starts_with("click 8, ") && click.ends_with("0.80 mm of travel"), "{click}");
    assert_eq!(field, "another field true: Plastic strain");
    assert!(values.starts_with("Travel 0.8") && values.contains("; Cutting force Fc "), "{values}");
    assert!(values.contains("; Feed force Ff ") && values.ends_with(" N/mm"), "{values}");
    assert_eq!(beside, "beside it hidden true");
    assert_eq!(touch, "after a touch hidden false");
}

/// Three tools whose forces grow in the direction of a wear land.
fn wear_page() -> String {
    let segment = |tool: usize, k: usize| {
        let wobble = [1.0, -1.0, 0.5, -0.5][k % 4];
        let forces = [(500.0, 0.25), (350.0, 0.9), (150.0, 0.43)]
            .map(|(f, d)| f + 4.0 * k as f64 * d + wobble);
        WearSegment { tool: tool.to_string(), time: 5.0 * k as f64, forces, land: None }
    };
    let all: Vec<WearSegment> =
        (0..3).flat_map(|tool| (0..20).map(move |k| segment(tool, k))).collect();
    let growth = grows(&all, 2).unwrap();
    render_wear(&WearPage { table: "tools.csv", growth: &growth, lands: None, version: "1" })
}

#[test]
fn a_plot_tells_the_point_next_to_the_pointer_and_elsewhere_the_place() {
    let Some(browser) = chromium() else {
        println!("skipped: no Chromium on this machine");
        return;
    };
    let probe = "const dots = [...document.querySelectorAll('svg[data-x]')].map(svg => svg.querySelectorAll('.dot')[19]);
        const at = (dot, right, down) => {
            const frame = dot.getBoundingClientRect();
            dot.closest('svg').dispatchEvent(new PointerEvent('pointermove', { bubbles: true,
                clientX: frame.left + 0.5 * frame.width + right, clientY: frame.top + 0.5 * frame.height + down }));
            return [...document.querySelector('.readout').children].map(row => row.textContent).join('; ');
        };
        const wide = document.documentElement.scrollWidth > document.documentElement.clientWidth;
        document.body.dataset.probe = [dots.length, at(dots[0], 3, 2), at(dots[0], -60, 0), wide].join(' | ');";
    let page = wear_page();
    for (width, scheme) in [(1300, "light"), (390, "dark")] {
        let (found, complaints) = probed(browser, (&page, probe), width, scheme);
        assert_eq!(complaints, "", "{width} {scheme}");
        let parts: Vec<&str> = found.split(" | ").collect();
        let [plots, dot, place, wide] = parts[..] else { panic!("{found}") };
        assert_eq!((plots, wide), ("6", "false"), "{width}");
        // The last segment: 19 intervals of 5 s.
        assert!(dot.starts_with("Time in cut 95.0 s; Force 7"), "{width}: {dot}");
        assert!(!place.contains(" 95.0 s") && place.contains("; Force "), "{width}: {place}");
    }
}

#[test]
fn the_page_loads_nothing_and_escapes_what_it_is_given() {
    let page = page();
    for attribute in ["src=\"", "href=\"", "srcset=\""] {
        for part in page.split(attribute).skip(1) {
            // Sections of the page itself, and pictures in it.
            let inside = part.starts_with("data:") || part.starts_with('#');
            assert!(inside, "{}", &part[..60.min(part.len())]);
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
    for (key, fields, pngs) in [("animation", 0, 8), ("pictures", 0, 0)] {
        run.provenance.settings = vec![sphcut_record::Setting {
            section: "output".to_owned(),
            key: key.to_owned(),
            text: "false".to_owned(),
            ..Default::default()
        }];
        let page = render_report(&run, &result).unwrap();
        let count = |what: &str| page.matches(what).count();
        let found = (count(" data-field="), count("data:image/png"));
        assert_eq!(found, (fields, pngs + 1), "{key}");
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
    let page = std::fs::read_to_string(path).unwrap();
    assert!(page.contains("How to reproduce") && page.contains("<h2>The run</h2>"));
    for of_a_cut in ["The cut", "Cutting force", "cutting force is steady", "Chip formation"] {
        assert!(!page.contains(of_a_cut), "{of_a_cut}");
    }
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
