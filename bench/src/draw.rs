//! [`Draw`]: the random choices of one frame.

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

/// Random numbers that depend on the seed, the scenario's name and the frame, and on nothing else: a frame stays the
/// same whichever others are drawn.
pub struct Draw(StdRng);

impl Draw {
    pub fn new(seed: u64, name: &str, frame: u32) -> Self {
        let mut key = [0; 32];
        let parts = seed.to_le_bytes().into_iter().chain(frame.to_le_bytes()).chain(name.bytes());
        key.iter_mut().zip(parts).for_each(|(key, part)| *key = part);
        Self(StdRng::from_seed(key))
    }

    pub fn within(&mut self, from: f32, to: f32) -> f32 {
        self.0.random_range(from..=to)
    }

    /// Near a value, by 5 % at most.
    pub fn about(&mut self, value: f32) -> f32 {
        value * self.within(0.95, 1.05)
    }

    /// 1 or −1.
    pub fn sign(&mut self) -> f32 {
        if self.0.random() { 1.0 } else { -1.0 }
    }

    pub fn number(&mut self) -> u32 {
        self.0.random()
    }
}
