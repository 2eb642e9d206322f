//! Feed-forward network with two hidden layers of rectified linear units (Eqs. 14 and 15).
//!
//! Inputs and target are standardised. The squared error with a small penalty of the weights is minimised by
//! Adam (Kingma and Ba 2015); training stops early when the error of validation conditions, drawn from the
//! training rows, has not improved for a while, and the weights of the best epoch are kept.

use super::Regressor;
use super::scaling::{InputScale, Scaling};
use crate::random::Random;
use crate::samples::{Input, TrainingRows};
use serde::{Deserialize, Serialize};

/// Size, penalty and length of training.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NetworkSettings {
    /// Neurons of both hidden layers.
    pub neurons: [usize; 2],
    /// Penalty of the squared weights.
    pub decay: f64,
    /// Step of Adam.
    pub learning_rate: f64,
    /// Share of the conditions that watch for over-fitting.
    pub validation_share: f64,
    /// Epochs without improvement after which training stops.
    pub patience: usize,
    /// Most epochs.
    pub epochs: usize,
    /// What the network sees.
    pub input_scale: InputScale,
}

/// A trained network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Network {
    scaling: Scaling,
    neurons: [usize; 2],
    /// First layer (weights by neuron, then biases), second, output.
    parameters: Vec<f64>,
}

/// Most rows of one step of Adam.
const BATCH: usize = 200;

impl NetworkSettings {
    /// Trains on `samples`.
    #[must_use]
    pub fn fit(&self, samples: &TrainingRows, seed: u64) -> Network {
        let scaling = Scaling::of(samples, self.input_scale);
        let scaled = scaling.samples(samples);
        let mut random = Random::new(seed, &[0x2e7]);
        let (training, watched) = self.divide(&scaled, &mut random);
        let layout = Layout::new(self.neurons);
        let mut parameters = layout.initial(&mut random);
        let mut best = (f64::INFINITY, parameters.clone(), 0);
        let mut adam = Adam::new(parameters.len(), self.learning_rate);
        let mut buffers = Buffers::new(self.neurons);
        let mut rows: Vec<usize> = (0..training.len()).collect();
        for epoch in 0..self.epochs {
            random.shuffle(&mut rows);
            for batch in rows.chunks(BATCH) {
                let gradient =
                    layout.gradient(&parameters, &training, batch, self.decay, &mut buffers);
                adam.step(&mut parameters, gradient);
            }
            let error = layout.error(&parameters, &watched, &mut buffers);
            if error < best.0 {
                best = (error, parameters.clone(), epoch);
            } else if epoch - best.2 >= self.patience {
                break;
            }
        }
        Network { scaling, neurons: self.neurons, parameters: best.1 }
    }

    /// Training rows and those that are watched: whole conditions, at least one.
    fn divide(&self, samples: &TrainingRows, random: &mut Random) -> (TrainingRows, TrainingRows) {
        let mut groups = samples.groups.clone();
        groups.sort_unstable();
        groups.dedup();
        random.shuffle(&mut groups);
        let count = (self.validation_share * groups.len() as f64).round().max(1.0) as usize;
        if groups.len() < 2 {
            return (samples.clone(), samples.clone());
        }
        let mut watched = groups[..count.min(groups.len() - 1)].to_vec();
        watched.sort_unstable();
        let is_watched = |row: usize| watched.binary_search(&samples.groups[row]).is_ok();
        (samples.filtered(|row| !is_watched(row)), samples.filtered(is_watched))
    }
}

impl Network {
    pub(crate) fn is_sound(&self) -> bool {
        self.neurons.iter().all(|&count| (1..=1024).contains(&count))
            && self.parameters.len() == Layout::new(self.neurons).count()
    }
}

impl Regressor for Network {
    fn predict(&self, input: Input) -> f64 {
        let mut buffers = Buffers::new(self.neurons);
        let layout = Layout::new(self.neurons);
        let output = layout.forward(&self.parameters, self.scaling.input(input), &mut buffers);
        self.scaling.undo(output)
    }
}

/// Where the parameters of the layers lie.
struct Layout {
    neurons: [usize; 2],
}

/// Values of the hidden neurons and their derivatives.
struct Buffers {
    first: Vec<f64>,
    second: Vec<f64>,
    first_slope: Vec<f64>,
    second_slope: Vec<f64>,
    gradient: Vec<f64>,
}

impl Buffers {
    fn new([first, second]: [usize; 2]) -> Self {
        Self {
            first: vec![0.0; first],
            second: vec![0.0; second],
            first_slope: vec![0.0; first],
            second_slope: vec![0.0; second],
            gradient: vec![0.0; Layout::new([first, second]).count()],
        }
    }
}

impl Layout {
    fn new(neurons: [usize; 2]) -> Self {
        Self { neurons }
    }

    /// Starts of: biases of the first layer, weights and biases of the second, weights and bias of the output.
    fn starts(&self) -> [usize; 5] {
        let [first, second] = self.neurons;
        let biases = 2 * first;
        let weights = biases + first;
        let second_biases = weights + first * second;
        let output = second_biases + second;
        [biases, weights, second_biases, output, output + second]
    }

    fn count(&self) -> usize {
        self.starts()[4] + 1
    }

    /// Weights uniform within sqrt(6 / (inputs + outputs)) (Glorot and Bengio 2010), biases likewise.
    fn initial(&self, random: &mut Random) -> Vec<f64> {
        let [first, second] = self.neurons;
        let [_, weights, _, output, _] = self.starts();
        let bound = |place: usize| {
            let sizes = match place {
                p if p < weights => 2 + first,
                p if p < output => first + second,
                _ => second + 1,
            };
            (6.0 / sizes as f64).sqrt()
        };
        (0..self.count()).map(|place| bound(place) * (2.0 * random.uniform() - 1.0)).collect()
    }

    fn forward(&self, parameters: &[f64], input: Input, buffers: &mut Buffers) -> f64 {
        let [first, _] = self.neurons;
        let [biases, weights, second_biases, output, last] = self.starts();
        for (k, value) in buffers.first.iter_mut().enumerate() {
            let sum = parameters[2 * k] * input[0] + parameters[2 * k + 1] * input[1];
            *value = (sum + parameters[biases + k]).max(0.0);
        }
        for (k, value) in buffers.second.iter_mut().enumerate() {
            let row = &parameters[weights + k * first..weights + (k + 1) * first];
            let sum: f64 = row.iter().zip(&buffers.first).map(|(w, x)| w * x).sum();
            *value = (sum + parameters[second_biases + k]).max(0.0);
        }
        let row = &parameters[output..last];
        row.iter().zip(&buffers.second).map(|(w, x)| w * x).sum::<f64>() + parameters[last]
    }

    /// Gradient of half the mean squared error and of the penalty.
    fn gradient<'a>(
        &self,
        parameters: &[f64],
        samples: &TrainingRows,
        rows: &[usize],
        decay: f64,
        buffers: &'a mut Buffers,
    ) -> &'a [f64] {
        let [_, weights, second_biases, output, last] = self.starts();
        let share = 1.0 / rows.len() as f64;
        buffers.gradient.fill(0.0);
        for &row in rows {
            let value = self.forward(parameters, samples.inputs[row], buffers);
            let slope = share * (value - samples.targets[row]);
            self.backward(parameters, samples.inputs[row], slope, buffers);
        }
        let is_weight = |place: usize| {
            place < self.starts()[0]
                || (weights..second_biases).contains(&place)
                || (output..last).contains(&place)
        };
        for (place, slope) in buffers.gradient.iter_mut().enumerate() {
            if is_weight(place) {
                *slope += share * decay * parameters[place];
            }
        }
        &buffers.gradient
    }

    /// Adds the derivatives of one row, `slope` being that of its output.
    fn backward(&self, parameters: &[f64], input: Input, slope: f64, buffers: &mut Buffers) {
        let [first, second] = self.neurons;
        let [biases, weights, second_biases, output, last] = self.starts();
        buffers.gradient[last] += slope;
        for k in 0..second {
            let active = if buffers.second[k] > 0.0 { 1.0 } else { 0.0 };
            buffers.gradient[output + k] += slope * buffers.second[k];
            buffers.second_slope[k] = active * slope * parameters[output + k];
        }
        buffers.first_slope.fill(0.0);
        for k in 0..second {
            let slope = buffers.second_slope[k];
            if slope == 0.0 {
                continue;
            }
            buffers.gradient[second_biases + k] += slope;
            let start = weights + k * first;
            for j in 0..first {
                buffers.gradient[start + j] += slope * buffers.first[j];
                buffers.first_slope[j] += slope * parameters[start + j];
            }
        }
        for j in 0..first {
            let slope = if buffers.first[j] > 0.0 { buffers.first_slope[j] } else { 0.0 };
            buffers.gradient[2 * j] += slope * input[0];
            buffers.gradient[2 * j + 1] += slope * input[1];
            buffers.gradient[biases + j] += slope;
        }
    }

    fn error(&self, parameters: &[f64], samples: &TrainingRows, buffers: &mut Buffers) -> f64 {
        let squares = samples.inputs.iter().zip(&samples.targets).map(|(&input, target)| {
            let error = self.forward(parameters, input, buffers) - target;
            error * error
        });
        squares.sum::<f64>() / samples.len() as f64
    }
}

/// Adam with its usual decay rates.
struct Adam {
    rate: f64,
    mean: Vec<f64>,
    square: Vec<f64>,
    powers: [f64; 2],
}

const DECAY: [f64; 2] = [0.9, 0.999];

impl Adam {
    fn new(count: usize, rate: f64) -> Self {
        Self { rate, mean: vec![0.0; count], square: vec![0.0; count], powers: [1.0; 2] }
    }

    fn step(&mut self, parameters: &mut [f64], gradient: &[f64]) {
        self.powers = [self.powers[0] * DECAY[0], self.powers[1] * DECAY[1]];
        let rate = self.rate * (1.0 - self.powers[1]).sqrt() / (1.0 - self.powers[0]);
        for (k, &slope) in gradient.iter().enumerate() {
            self.mean[k] = DECAY[0] * self.mean[k] + (1.0 - DECAY[0]) * slope;
            self.square[k] = DECAY[1] * self.square[k] + (1.0 - DECAY[1]) * slope * slope;
            parameters[k] -= rate * self.mean[k] / (self.square[k].sqrt() + 1e-8);
        }
    }
}
