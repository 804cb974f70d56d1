// A world of some recipe as the benchmark of joints sees it, so that its unit holds little code but the library's.
#pragma once

namespace bench {

/// So many pairs of a static body and a ball, joined if the recipe names a kind of joints.
void* make(int pairs, bool joined);
void step(void* world);
void* copy(void* world);
void drop(void* world);

}  // namespace bench
