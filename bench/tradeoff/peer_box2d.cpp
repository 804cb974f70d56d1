// The adapter of bench/scenes.
// peer: box2d/box2d.h=libbox2d-dev -lbox2d
#include "../scenes/peer_box2d.cpp"
