//! Pictures of a hand-drawn cut: right size, right colours, and something to look at
//! (`SPHCUT_PICTURES=folder cargo test -p sphcut-report` keeps them).

use sphcut_postprocess::synthetic::SyntheticCut;
use sphcut_report::{Field, PictureOptions, render_snapshot};

fn keep(name: &str, bytes: &[u8]) {
    if let Ok(folder) = std::env::var("SPHCUT_PICTURES") {
        std::fs::write(std::path::Path::new(&folder).join(name), bytes).unwrap();
    }
}

#[test]
fn every_field_of_a_cut_becomes_a_picture() {
    let cut = SyntheticCut { orientation: 0.0, ..SyntheticCut::default() };
    let snapshot = cut.snapshot(1.2e-3);
    for field in Field::ALL {
        let bytes = render_snapshot(&snapshot, field, &PictureOptions::default());
        keep(&format!("{}.png", field.name()), &bytes);
        let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        assert_eq!(reader.info().width, 1200);
        assert!(reader.info().height > 200);
    }
}
