// The adapter of bench/scenes.
// peer: chipmunk/chipmunk.h=chipmunk-dev -lchipmunk -lm
#include "../scenes/peer_chipmunk.cpp"
