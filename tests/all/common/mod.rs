//! What several tests share.

pub mod agreement;
pub mod aimed;
pub mod alone;
pub mod answers;
pub mod at_hits;
pub mod closed;
pub mod heuristics;
pub mod hostile;
pub mod in_every_mode;
pub mod integers;
pub mod modes;
pub mod naive;
pub mod range;
pub mod rational;
pub mod rays;
pub mod scattered;
pub mod soups;
pub mod textbook;
