//! Sweeps on a cluster: one job array of Slurm, whose tasks run their share of the plan through the same store.
//!
//! What is missing is dealt out to tasks of about equal cost ([`deal`]), a batch script asks for what the costliest
//! needs ([`request`], [`array_script`]), a second job writes table and page when the array has ended, however it
//! ended. What was submitted is noted in a folder of its own ([`Submission`]); what became of it is asked of the
//! queue ([`queue`]) and of the store.

mod client;
mod deal;
mod script;
mod submission;

pub use client::{Queued, SlurmError, cancel, is_possible, most_tasks, queue, submit};
pub use deal::{JobRequest, LEAD_SECONDS, Task, deal, request};
pub use script::{Script, array_script, collecting_script, refused_option, refused_path};
pub use submission::{Submission, TaskRun};
