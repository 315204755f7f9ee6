// The figures that hard cases are judged by; each a function of what a Glance shows. In double precision, over the particles of cloth.
#pragma once

#include "samples/weft/hard_cases.h"

namespace weft::command::figure {

double not_finite(const Glance& at);           // particles that are not finite now, and times that one was put back
double crossings(const Glance& at);            // pairs of edge and triangle
double contacts_overflowed(const Glance& at);
double pins_off(const Glance& at);             // m, from where the scene has them
double largest_strain(const Glance& at);       // %
double mean_strain(const Glance& at);          // %
double top_speed(const Glance& at);            // m/s

double centre_moved(const Glance& at);         // m
double momentum_change(const Glance& at);      // of sum m |v| at the start
double spin(const Glance& at);                 // rad/s: angular momentum over sum m r^2, about the centre
double fall_error(const Glance& at);           // of the integrator's closed form
double sideways(const Glance& at);             // m across gravity

double bend_angle(const Glance& at);           // rad, the largest off the rest between two triangles
double deepest(const Glance& at);              // m, into the planes and spheres where they stand at first
double out_of_order(const Glance& at);         // cloths whose centre is not above the centre of the one before
double unaccounted(const Glance& at);          // s that were neither simulated nor given back nor kept for the next frame

double slide_error(const Glance& at);          // |slid - what Coulomb allows|, of a slide without friction
double strip_error(const Glance& at);          // of how much longer a strip hangs
double catenary_error(const Glance& at);       // m, rms, of the length
double cantilever_error(const Glance& at);     // of how far the tip sinks
double pendulum_error(const Glance& at);       // of the period
double drape_order(const Glance& at);          // the drape coefficient of a cloth over that of the next, which is stiffer; the largest

}  // namespace weft::command::figure
