//! The grids of the search, simplest settings first: of equals the first is taken.

use super::{
    BoostingSettings, ForestSettings, GaussianProcessSettings, InputScale, Method, NetworkSettings,
    PolynomialSettings, RegressorSettings, SupportVectorSettings,
};

const SCALES: [InputScale; 2] = [InputScale::Linear, InputScale::Logarithmic];

pub(super) fn grid(method: Method) -> Vec<RegressorSettings> {
    let polynomial = |degree| vec![RegressorSettings::Polynomial(PolynomialSettings { degree })];
    match method {
        Method::Linear => polynomial(1),
        Method::Quadratic => polynomial(2),
        Method::Quartic => polynomial(4),
        Method::SupportVector => support_vectors(),
        Method::Forest => forests(),
        Method::Boosting => boosting(),
        Method::Network => networks(),
        Method::GaussianProcess => {
            vec![RegressorSettings::GaussianProcess(GaussianProcessSettings {
                input_scales: SCALES.to_vec(),
            })]
        }
    }
}

fn support_vectors() -> Vec<RegressorSettings> {
    let mut grid = Vec::new();
    for input_scale in SCALES {
        for penalty in [1.0, 10.0, 100.0] {
            for sharpness in [0.1, 0.3, 1.0] {
                for tube in [0.1, 0.02] {
                    let settings = SupportVectorSettings { penalty, tube, sharpness, input_scale };
                    grid.push(RegressorSettings::SupportVector(settings));
                }
            }
        }
    }
    grid
}

fn forests() -> Vec<RegressorSettings> {
    let mut grid = Vec::new();
    for min_leaf in [4, 2, 1] {
        for inputs_per_split in [1, 2] {
            let settings = ForestSettings { trees: 200, max_depth: 16, min_leaf, inputs_per_split };
            grid.push(RegressorSettings::Forest(settings));
        }
    }
    grid
}

fn boosting() -> Vec<RegressorSettings> {
    let mut grid = Vec::new();
    for trees in [100, 300] {
        for max_depth in [2, 3, 4] {
            for learning_rate in [0.05, 0.1, 0.3] {
                grid.push(RegressorSettings::Boosting(BoostingSettings {
                    trees,
                    max_depth,
                    learning_rate,
                    lambda: 1.0,
                    split_penalty: 0.0,
                    min_leaf: 1,
                }));
            }
        }
    }
    grid
}

fn networks() -> Vec<RegressorSettings> {
    let mut grid = Vec::new();
    for input_scale in SCALES {
        for neurons in [[8, 8], [16, 16]] {
            for decay in [1e-2, 1e-4] {
                grid.push(RegressorSettings::Network(NetworkSettings {
                    neurons,
                    decay,
                    learning_rate: 0.01,
                    validation_share: 0.15,
                    patience: 60,
                    epochs: 1500,
                    input_scale,
                }));
            }
        }
    }
    grid
}
