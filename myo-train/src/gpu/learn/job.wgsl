    // The job that this tile belongs to.
    var begin = 0u;
    var index = 0u;
    while index + 1u < all.jobs && tile >= jobs[index].end {
        begin = jobs[index].end;
        index += 1u;
    }
    if tile >= jobs[index].end { return; }
    let job = jobs[index];