/* The map as a model: outputs follow from inputs whenever they are asked for, so a step only moves the time. */
#include "model.h"

#include <stdlib.h>
#include <string.h>

Model *model_new(const char *token)
{
    Model *model;

    if (!token || strcmp(token, MAP_TOKEN))
        return NULL;
    model = (Model *)calloc(1, sizeof(Model));
    if (model)
        model_reset(model);
    return model;
}

void model_reset(Model *model)
{
    memset(model, 0, sizeof(Model));
    memcpy(model->inputs, map_start, sizeof(model->inputs));
}

static void update(Model *model)
{
    if (!model->known)
        model->valid = map_evaluate(model->inputs, model->outputs, NULL);
    model->known = 1;
}

int model_get(Model *model, unsigned int reference, double *value)
{
    if (reference < MAP_INPUTS) {
        *value = model->inputs[reference];
    } else if (reference < MODEL_ERROR) {
        update(model);
        *value = model->outputs[reference - MAP_INPUTS];
    } else if (reference == MODEL_ERROR) {
        update(model);
        *value = model->valid ? MAP_ERROR : 1.0;
    } else if (reference == MODEL_TIME) {
        *value = model->time;
    } else {
        return 0;
    }
    return 1;
}

int model_set(Model *model, unsigned int reference, double value)
{
    if (reference >= MAP_INPUTS)
        return 0;
    model->inputs[reference] = value;
    model->known = 0;
    return 1;
}

int model_is_valid(Model *model)
{
    update(model);
    return model->valid;
}

int model_slope(Model *model, unsigned int unknown, unsigned int known, double *value)
{
    double outputs[MAP_OUTPUTS], gradient[MAP_OUTPUTS * MAP_INPUTS];

    if (known >= MAP_INPUTS || unknown < MAP_INPUTS || unknown > MODEL_ERROR)
        return 0;
    if (unknown == MODEL_ERROR) {
        *value = 0.0;
        return 1;
    }
    map_evaluate(model->inputs, outputs, gradient);
    *value = gradient[(unknown - MAP_INPUTS) * MAP_INPUTS + known];
    return 1;
}
