// For kernels that make tiles of many jobs: `jobs` is their table, with the tiles up to the end of each.

// The job that a tile belongs to, and the tiles of those before it.
struct JobOfTile {
    index: u32,
    begin: u32,
}

// Tiles after the last job lie beyond its columns and keep nothing.
fn job_of(tile: u32) -> JobOfTile {
    var begin = 0u;
    var index = 0u;
    while index + 1u < all.jobs && tile >= jobs[index].end {
        begin = jobs[index].end;
        index += 1u;
    }
    return JobOfTile(index, begin);
}
