/// Measures the constitutive models on their own: time per point and update, beside that of `mohr_coulomb`.
#pragma once

void measure_materials(bool smoke);
