    // The job that this tile belongs to. Tiles after the last one lie beyond its columns and keep nothing.
    var begin = 0u;
    var index = 0u;
    while index + 1u < all.jobs && tile >= jobs[index].end {
        begin = jobs[index].end;
        index += 1u;
    }
    let job = jobs[index];