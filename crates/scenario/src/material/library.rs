//! The materials that come with the program. One line for each file of
//! `scenarios/materials/`; a test compares the list with the directory.

macro_rules! materials {
    ($($name:literal),* $(,)?) => {
        /// Name and text of every shipped material.
        pub(crate) const MATERIALS: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../../../scenarios/materials/", $name, ".toml")))),*];
    };
}

materials![
    "aa7075_t651",
    "aisi1045_jaspers",
    "aisi1045_mie_gruneisen",
    "aisi1045_table5",
    "aisi1045_temperature_dependent",
    "en_aw_6262a_t8",
    "en_aw_6262a_t8_mie_gruneisen",
    "en_aw_6262a_t8_temperature_dependent",
    "ofhc_copper_johnson_cook",
    "ofhc_copper_linear",
    "ti6al4v_calamaz",
    "ti6al4v_johnson_1985",
    "ti6al4v_klippel_2026",
    "ti6al4v_mie_gruneisen",
    "ti6al4v_seo_2005",
    "ti6al4v_sima_ozel",
    "ti6al4v_temperature_dependent",
];

/// The text of a shipped material.
pub(crate) fn find(name: &str) -> Option<&'static str> {
    MATERIALS.iter().find(|material| material.0 == name).map(|material| material.1)
}

/// The names of the shipped materials.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    MATERIALS.iter().map(|material| material.0)
}
