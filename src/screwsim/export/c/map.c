/* Evaluation of a map: tensor products of cubic Hermite polynomials on a grid, so value and gradient are continuous. */
#include "map.h"

#include <math.h>

#define CORNERS (1 << MAP_INPUTS) /* of a cell; as many are the mixed derivatives at each */

/* What one input has to do with the cell that it lies in. */
typedef struct {
    int cell;
    double weight[2][2]; /* of value and slope at both ends */
    double change[2][2]; /* derivatives of these by the input */
} Place;

/* Find cell and weights of an input; return 0 where it is beyond its range, or no number. */
static int place(int axis, double x, Place *found)
{
    const double *nodes = map_nodes + map_first[axis];
    int low = 0, high = map_count[axis] - 1;
    int inside = x >= map_low[axis] * (1.0 - 1e-12 * (map_low[axis] > 0.0 ? 1.0 : -1.0))
        && x <= map_high[axis] * (1.0 + 1e-12 * (map_high[axis] > 0.0 ? 1.0 : -1.0));
    double u, width, t, s, slope;

    if (!(x >= map_low[axis]))
        x = map_low[axis];
    if (x > map_high[axis])
        x = map_high[axis];
    u = map_logarithmic[axis] ? log(x) : x;
    if (u < nodes[0])
        u = nodes[0];
    if (u > nodes[high])
        u = nodes[high];
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (u < nodes[middle])
            high = middle;
        else
            low = middle;
    }
    width = nodes[low + 1] - nodes[low];
    t = (u - nodes[low]) / width;
    s = 1.0 - t;
    slope = inside ? (map_logarithmic[axis] ? 1.0 / x : 1.0) : 0.0;
    found->cell = low;
    found->weight[0][0] = s * s * (1.0 + 2.0 * t);
    found->weight[0][1] = width * t * s * s;
    found->weight[1][0] = t * t * (3.0 - 2.0 * t);
    found->weight[1][1] = -width * t * t * s;
    found->change[0][0] = -6.0 * t * s / width * slope;
    found->change[0][1] = s * (s - 2.0 * t) * slope;
    found->change[1][0] = 6.0 * t * s / width * slope;
    found->change[1][1] = t * (t - 2.0 * s) * slope;
    return inside;
}

int map_evaluate(const double x[MAP_INPUTS], double y[MAP_OUTPUTS], double *gradient)
{
    Place places[MAP_INPUTS];
    int inside = 1, axis, corner, order, i;

    for (axis = 0; axis < MAP_INPUTS; axis++)
        inside &= place(axis, x[axis], &places[axis]);
    for (i = 0; i < MAP_OUTPUTS; i++)
        y[i] = 0.0;
    for (i = 0; gradient && i < MAP_OUTPUTS * MAP_INPUTS; i++)
        gradient[i] = 0.0;
    for (corner = 0; corner < CORNERS; corner++) {
        int node = 0;
        const double *data;
        for (axis = 0; axis < MAP_INPUTS; axis++)
            node = node * map_count[axis] + places[axis].cell + (corner >> axis & 1);
        inside &= map_sound[node];
        data = map_data + (long)node * CORNERS * MAP_OUTPUTS;
        for (order = 0; order < CORNERS; order++, data += MAP_OUTPUTS) {
            double weight = 1.0;
            for (axis = 0; axis < MAP_INPUTS; axis++)
                weight *= places[axis].weight[corner >> axis & 1][order >> axis & 1];
            for (i = 0; i < MAP_OUTPUTS; i++)
                y[i] += weight * data[i];
            for (axis = 0; gradient && axis < MAP_INPUTS; axis++) {
                double change = places[axis].change[corner >> axis & 1][order >> axis & 1];
                int other;
                for (other = 0; other < MAP_INPUTS; other++)
                    if (other != axis)
                        change *= places[other].weight[corner >> other & 1][order >> other & 1];
                for (i = 0; i < MAP_OUTPUTS; i++)
                    gradient[i * MAP_INPUTS + axis] += change * data[i];
            }
        }
    }
    return inside;
}
