//! Chip, shear zone, contact and residual stress in `summary.json`. Where a measure has no value its
//! `reason` says why.

use super::MM_PER_M;
use crate::geometry::{EdgeSection, Geometry};
use crate::interface::InterfaceBin;
use crate::missing::Missing;
use crate::result::ProcessResult;
use crate::result::StressBin;
use serde::Serialize;

const MPA_PER_PA: f64 = 1e-6;

/// Why there is no value; null where there is one.
fn reason<T>(measure: &Result<T, Missing>) -> Option<String> {
    measure.as_ref().err().map(ToString::to_string)
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct ChipEntry {
    thickness_mm: Option<f64>,
    thickness_deviation_mm: Option<f64>,
    thickness_quartiles_mm: Option<[f64; 2]>,
    compression_ratio: Option<f64>,
    compression_ratio_by_speed: Option<f64>,
    snapshots: usize,
    reason: Option<String>,
    rake_angle_deg: Option<f64>,
    shear_angle_deg: Option<f64>,
    segmentation: SegmentationEntry,
}

impl ChipEntry {
    pub fn of(geometry: &Geometry) -> Self {
        let chip = geometry.chip.as_ref().ok();
        Self {
            thickness_mm: chip.map(|c| c.thickness * MM_PER_M),
            thickness_deviation_mm: chip.map(|c| c.thickness_deviation * MM_PER_M),
            thickness_quartiles_mm: chip.map(|c| c.quartiles.map(|q| q * MM_PER_M)),
            compression_ratio: chip.map(|c| c.compression_ratio),
            compression_ratio_by_speed: chip.map(|c| c.speed_ratio),
            snapshots: chip.map_or(0, |c| c.snapshots),
            reason: reason(&geometry.chip),
            rake_angle_deg: geometry.rake_angle.map(f64::to_degrees),
            shear_angle_deg: geometry.shear_angle.as_ref().ok().map(|angle| angle.to_degrees()),
            segmentation: SegmentationEntry::of(geometry),
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct SegmentationEntry {
    teeth: Option<usize>,
    pitch_mm: Option<f64>,
    pitch_deviation_mm: Option<f64>,
    undeformed_pitch_mm: Option<f64>,
    frequency_hz: Option<f64>,
    tip_thickness_mm: Option<f64>,
    valley_thickness_mm: Option<f64>,
    degree: Option<f64>,
    reason: Option<String>,
}

impl SegmentationEntry {
    fn of(geometry: &Geometry) -> Self {
        let found = geometry.segments.as_ref().ok();
        Self {
            teeth: found.map(|s| s.teeth),
            pitch_mm: found.map(|s| s.pitch * MM_PER_M),
            pitch_deviation_mm: found.map(|s| s.pitch_deviation * MM_PER_M),
            undeformed_pitch_mm: found.map(|s| s.undeformed_pitch * MM_PER_M),
            frequency_hz: found.map(|s| s.frequency),
            tip_thickness_mm: found.map(|s| s.tip_thickness * MM_PER_M),
            valley_thickness_mm: found.map(|s| s.valley_thickness * MM_PER_M),
            degree: found.map(crate::Segments::degree),
            reason: reason(&geometry.segments),
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct ShearZoneEntry {
    angle_deg: Option<f64>,
    width_mm: Option<f64>,
    strain_rate_per_s: Option<f64>,
    peak_strain_rate_per_s: Option<f64>,
    shear_strain_rate_per_s: Option<f64>,
    reason: Option<String>,
}

impl ShearZoneEntry {
    pub fn of(geometry: &Geometry) -> Self {
        let zone = geometry.shear_zone.as_ref().ok();
        Self {
            angle_deg: zone.map(|z| z.angle.to_degrees()),
            width_mm: zone.map(|z| z.width * MM_PER_M),
            strain_rate_per_s: zone.map(|z| z.strain_rate),
            peak_strain_rate_per_s: zone.map(|z| z.peak_rate),
            shear_strain_rate_per_s: zone.map(crate::ShearZone::shear_strain_rate),
            reason: reason(&geometry.shear_zone),
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct ContactEntry {
    length_mm: Option<f64>,
    rake_mm: Option<f64>,
    flank_mm: Option<f64>,
    deviation_mm: Option<f64>,
    sticking_mm: Option<f64>,
    without_slip_mm: Option<f64>,
    reason: Option<String>,
}

impl ContactEntry {
    pub fn of(geometry: &Geometry) -> Self {
        let contact = geometry.contact.as_ref().ok();
        let untold = contact.is_some_and(|c| c.sticking.is_none());
        Self {
            length_mm: contact.map(|c| c.length() * MM_PER_M),
            rake_mm: contact.map(|c| c.rake * MM_PER_M),
            flank_mm: contact.map(|c| c.flank * MM_PER_M),
            deviation_mm: contact.map(|c| c.deviation * MM_PER_M),
            sticking_mm: contact.and_then(|c| c.sticking).map(|l| l * MM_PER_M),
            without_slip_mm: contact.and_then(|c| c.without_slip).map(|l| l * MM_PER_M),
            reason: if untold {
                Some(Missing::StickingNotRecorded.to_string())
            } else {
                reason(&geometry.contact)
            },
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct AlongEdgeEntry {
    uncut_section_mm2: Option<f64>,
    contact_area_mm2: Option<f64>,
    sections: Vec<SectionEntry>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct SectionEntry {
    place_mm: f64,
    uncut_chip_thickness_mm: f64,
    chip_thickness_mm: Option<f64>,
    compression_ratio: Option<f64>,
    shear_angle_deg: Option<f64>,
    contact_rake_mm: Option<f64>,
    contact_flank_mm: Option<f64>,
    reason: Option<String>,
}

impl AlongEdgeEntry {
    pub fn of(geometry: &Geometry) -> Self {
        let along = geometry.along_edge.as_ref();
        let sections = along.map(|along| along.sections.iter().map(SectionEntry::of).collect());
        Self {
            uncut_section_mm2: along.map(|along| along.uncut_section * MM_PER_M.powi(2)),
            contact_area_mm2: along
                .and_then(|along| along.contact_area)
                .map(|area| area * MM_PER_M.powi(2)),
            sections: sections.unwrap_or_default(),
        }
    }
}

impl SectionEntry {
    fn of(section: &EdgeSection) -> Self {
        let chip = section.chip.as_ref().ok();
        let contact = section.contact.as_ref().ok();
        Self {
            place_mm: section.place * MM_PER_M,
            uncut_chip_thickness_mm: section.uncut_chip_thickness * MM_PER_M,
            chip_thickness_mm: chip.map(|chip| chip.thickness * MM_PER_M),
            compression_ratio: chip.map(|chip| chip.compression_ratio),
            shear_angle_deg: section.shear_angle.as_ref().ok().map(|angle| angle.to_degrees()),
            contact_rake_mm: contact.map(|contact| contact.rake * MM_PER_M),
            contact_flank_mm: contact.map(|contact| contact.flank * MM_PER_M),
            reason: reason(&section.chip),
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct InterfaceEntry {
    contact_length_mm: Option<f64>,
    sticking_length_mm: Option<f64>,
    sliding_length_mm: Option<f64>,
    mean_temperature_k: Option<f64>,
    max_temperature_k: Option<f64>,
    max_temperature_deviation_k: Option<f64>,
    reason: Option<String>,
    profile: Vec<InterfaceBinEntry>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct InterfaceBinEntry {
    distance_mm: f64,
    normal_stress_mpa: f64,
    shear_stress_mpa: f64,
    temperature_k: f64,
    sticking: f64,
}

impl InterfaceEntry {
    pub fn of(geometry: &Geometry) -> Self {
        let interface = geometry.interface.as_ref().ok();
        let bin = |bin: &InterfaceBin| InterfaceBinEntry {
            distance_mm: bin.distance * MM_PER_M,
            normal_stress_mpa: bin.normal_stress * MPA_PER_PA,
            shear_stress_mpa: bin.shear_stress * MPA_PER_PA,
            temperature_k: bin.temperature,
            sticking: bin.sticking,
        };
        let sticking = interface.and_then(|i| i.sticking_length);
        let sliding = interface.and_then(|i| Some(i.contact_length - i.sticking_length?));
        Self {
            contact_length_mm: interface.map(|i| i.contact_length * MM_PER_M),
            sticking_length_mm: sticking.map(|length| length * MM_PER_M),
            sliding_length_mm: sliding.map(|length| length * MM_PER_M),
            mean_temperature_k: interface.map(|i| i.mean_temperature),
            max_temperature_k: interface.map(|i| i.max_temperature),
            max_temperature_deviation_k: interface.map(|i| i.max_deviation),
            reason: reason(&geometry.interface),
            profile: interface.map(|i| i.profile.iter().map(bin).collect()).unwrap_or_default(),
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct ResidualStressEntry {
    reason: Option<String>,
    profile: Vec<StressEntry>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct StressEntry {
    depth_mm: f64,
    cutting_mpa: f64,
    cutting_ci95_mpa: f64,
    across_mpa: f64,
    across_ci95_mpa: f64,
    normal_mpa: f64,
}

impl ResidualStressEntry {
    pub fn of(result: &ProcessResult) -> Self {
        let bin = |bin: &StressBin| StressEntry {
            depth_mm: bin.depth * MM_PER_M,
            cutting_mpa: bin.cutting * MPA_PER_PA,
            cutting_ci95_mpa: bin.cutting_ci95 * MPA_PER_PA,
            across_mpa: bin.across * MPA_PER_PA,
            across_ci95_mpa: bin.across_ci95 * MPA_PER_PA,
            normal_mpa: bin.normal * MPA_PER_PA,
        };
        let found = &result.residual_stress;
        Self {
            reason: reason(found),
            profile: found.as_ref().map(|s| s.iter().map(bin).collect()).unwrap_or_default(),
        }
    }
}
