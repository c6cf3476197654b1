#include "types.hpp"

// fx, fy, cx, cy, k1, k2, p1, p2, k3 as in OpenCV; camera frame: z forward.
vec2 Camera::sensor2image(const vec3& point) const {
    const Camera& c = *this;
    const double x = point[0] / point[2], y = point[1] / point[2], r2 = x * x + y * y;
    const double radial = 1 + r2 * (c[4] + r2 * (c[5] + r2 * c[8]));
    return vec2(c[0] * (x * radial + 2 * c[6] * x * y + c[7] * (r2 + 2 * x * x)) + c[2],
                c[1] * (y * radial + c[6] * (r2 + 2 * y * y) + 2 * c[7] * x * y) + c[3]);
}
