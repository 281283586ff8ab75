#include <cstdlib>
int TestLacunaSweptVolume(int, char*[]) { return EXIT_SUCCESS; }
