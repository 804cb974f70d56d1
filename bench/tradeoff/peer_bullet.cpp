// The adapter of bench/scenes.
// peer: bullet/LinearMath/btScalar.h=libbullet-dev -I/usr/include/bullet -lBulletDynamics
// peer: bullet/LinearMath/btScalar.h=libbullet-dev -lBulletCollision -lLinearMath
#include "../scenes/peer_bullet.cpp"
