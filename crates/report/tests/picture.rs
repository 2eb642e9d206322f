//! Pictures of a hand-drawn cut: right size, right colours, and something to look at
//! (`SPHCUT_PICTURES=folder cargo test -p sphcut-report` keeps them).

use sphcut_postprocess::synthetic::SyntheticCut;
use sphcut_report::{ParticleField, PictureOptions, Style, render_snapshot};
use sphcut_sph::Snapshot;

fn keep(name: &str, bytes: &[u8]) {
    if let Ok(folder) = std::env::var("SPHCUT_PICTURES") {
        std::fs::write(std::path::Path::new(&folder).join(name), bytes).unwrap();
    }
}

#[test]
fn every_field_of_a_cut_becomes_a_picture() {
    let cut = SyntheticCut { orientation: 0.0, ..SyntheticCut::default() };
    let snapshot = cut.snapshot(1.2e-3);
    for field in ParticleField::ALL {
        let bytes = render_snapshot(&snapshot, field, &PictureOptions::default());
        keep(&format!("{}.png", field.name()), &bytes);
        let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        assert_eq!(reader.info().width, 1200);
        assert!(reader.info().height > 200);
    }
}

#[test]
fn a_block_in_space_and_its_tool_become_a_picture() {
    let cut = SyntheticCut { particle_spacing: 50e-6, ..SyntheticCut::default() };
    let mut snapshot = cut.snapshot(0.4e-3);
    snapshot.dimension = 3;
    snapshot.tool.truncate(3);
    // Half of the particles in front: the hot ones hide the cold ones behind.
    let count = snapshot.id.len();
    for k in 0..count {
        snapshot.temperature[k] = if k % 2 == 0 { 300.0 } else { 900.0 };
        snapshot.position[k] = [1e-3 * (k / 2) as f64 / count as f64, 0.0, (k % 2) as f64 * 1e-3];
    }
    let options = PictureOptions { style: Style::Material, ..PictureOptions::default() };
    let bytes = render_snapshot(&snapshot, ParticleField::Temperature, &options);
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    let width = reader.info().width as usize;
    // The plot ends where the colour bar begins, at 0.85 of the width.
    let is_cold =
        |k: usize, p: &[u8]| k % width < width * 8 / 10 && p[0] < 40 && p[2] > 50 && p[2] < 70;
    let is_hot = |p: &[u8]| p[0] > 230 && p[1] > 230 && p[2] < 200;
    assert!(pixels.chunks_exact(3).filter(|p| is_hot(p)).count() > 500);
    let cold = pixels.chunks_exact(3).enumerate().filter(|(k, p)| is_cold(*k, p)).count();
    assert!(cold < 50, "{cold} pixels of hidden particles");
}

#[test]
fn a_snapshot_with_nothing_or_nonsense_in_it_becomes_a_picture() {
    let empty = Snapshot { dimension: 2, ..Snapshot::default() };
    assert!(!render_snapshot(&empty, ParticleField::Speed, &PictureOptions::default()).is_empty());
    let mut snapshot =
        SyntheticCut { particle_spacing: 50e-6, ..SyntheticCut::default() }.snapshot(0.0);
    snapshot.position[3] = [f64::NAN, f64::INFINITY, 0.0];
    snapshot.position[4] = [1e300, -1e300, 0.0];
    snapshot.temperature[5] = f64::NAN;
    for style in [Style::Particles, Style::Material] {
        let options = PictureOptions { style, ..PictureOptions::default() };
        assert!(!render_snapshot(&snapshot, ParticleField::Temperature, &options).is_empty());
    }
}
