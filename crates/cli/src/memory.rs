//! Memory that the system does not give is an error with an exit code, not an abort. The only unsafe code of sphcut: a
//! global allocator cannot be written without.

#![expect(
    unsafe_code,
    reason = "GlobalAlloc is an unsafe trait; every call is passed on unchanged"
)]

use sphcut_cli::ExitCode;
use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;

/// The allocator of the system, whose refusal ends the program. Files are safe at any moment: what was saved stays.
pub struct Told;

#[global_allocator]
static ALLOCATOR: Told = Told;

// SAFETY: every call goes to the allocator of the system as it came.
unsafe impl GlobalAlloc for Told {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        given(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        unsafe { System.dealloc(place, layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        given(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        given(unsafe { System.realloc(place, layout, size) }, size)
    }
}

#[inline]
fn given(place: *mut u8, bytes: usize) -> *mut u8 {
    if place.is_null() {
        refused(bytes);
    }
    place
}

/// Says so without asking for memory, and ends the program; destructors that wait for other threads do not run.
#[cold]
fn refused(bytes: usize) -> ! {
    let _ = writeln!(
        std::io::stderr(),
        "error: the system refuses {bytes} bytes of memory\n  help: `sphcut check` says how much a scenario needs; a run \
         keeps its last checkpoint, and --resume goes on from there"
    );
    std::process::exit(i32::from(ExitCode::InputOutput.number()))
}
