$ZERO
$FETCH_FIRST
    // Which half of the shared memory this depth takes.
    var half = 0u;
    for (var depth = 0u; depth < shape.inputs; depth += DEPTH) {
$STORE
        workgroupBarrier();
$FETCH_NEXT
$MULTIPLY
        half = 1u - half;
    }
$FINISH