/* A map of a compressor: inputs and outputs in SI units. Its numbers are in map_data.h. */
#ifndef MAP_H
#define MAP_H

#include "map_data.h"

/* Write the outputs at the inputs x, and where gradient is not NULL their derivatives, those of one output together.
   Beyond the ranges of the inputs the outputs are held as they are at the border. Return 1 inside, where cycles closed
   all around, and 0 outside. */
int map_evaluate(const double x[MAP_INPUTS], double y[MAP_OUTPUTS], double *gradient);

#endif
