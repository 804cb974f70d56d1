// What the judge of bench/scenes sees.
#include "../scenes/pieces.cpp"
