// The adapter of bench/scenes.
// peer: ode/ode.h=libode-dev -lode
#include "../scenes/peer_ode.cpp"
