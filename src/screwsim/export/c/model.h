/* The map as a model of FMI: its variables by reference, and the state of one instance. Both versions share it. */
#ifndef MODEL_H
#define MODEL_H

#include <stddef.h>

#include "map.h"

/* References: inputs from 0 on, then outputs, then these two. */
#define MODEL_ERROR (MAP_INPUTS + MAP_OUTPUTS)
#define MODEL_VALID (MODEL_ERROR + 1)
#define MODEL_TIME (MODEL_ERROR + 2)

typedef struct {
    double inputs[MAP_INPUTS];
    double outputs[MAP_OUTPUTS];
    double time;
    int valid;
    int known; /* do the outputs belong to the inputs? */
} Model;

Model *model_new(const char *token); /* NULL for another token than that of this model */
void model_reset(Model *model);
int model_get(Model *model, unsigned int reference, double *value); /* 0 for a reference that is no number */
int model_set(Model *model, unsigned int reference, double value);  /* 0 for one that is no input */
int model_is_valid(Model *model);
int model_slope(Model *model, unsigned int unknown, unsigned int known, double *value); /* 0 where there is none */

#endif
