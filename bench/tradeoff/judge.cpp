// The judge of bench/scenes.
#include "../scenes/judge.cpp"
