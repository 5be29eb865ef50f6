//! One soup of corners, as every kind of primitive.

use bvhkit::{Aabb, Intersect, OneByOne, Primitive, Ray, Scalar, Sphere, Triangle};

/// Three points; each kind of primitive uses them in its own way.
pub type Corners<S> = [[S; 3]; 3];

pub fn triangles<S: Scalar>(soup: &[Corners<S>]) -> Vec<Triangle<S>> {
    soup.iter().map(|&[a, b, c]| Triangle { a, b, c }).collect()
}

pub fn spheres<S: Scalar>(soup: &[Corners<S>]) -> Vec<Sphere<S>> {
    soup.iter().map(|[a, b, _]| Sphere::new(*a, (b[0] - a[0]).abs())).collect()
}

pub fn boxes<S: Scalar>(soup: &[Corners<S>]) -> Vec<Aabb<S>> {
    soup.iter().map(|&corners| Aabb::of_points(corners)).collect()
}

/// A user's primitive that keeps no rule except that it is a pure function.
///
/// It is a disc in a plane of constant z. Its test ignores the interval, and the t it answers may
/// be wrong by a tenth, negated or NaN.
pub struct Disc<S> {
    center: [S; 3],
    radius: S,
    error: S,
}

pub fn discs<S: Scalar>(soup: &[Corners<S>]) -> Vec<Disc<S>> {
    let errors = [0.9, 1.0, 1.1, f64::NAN, -1.0, 1.0, 1.0].map(S::from_f64);
    let disc = |([a, b, _], error): (&Corners<S>, _)| Disc { center: *a, radius: (b[0] - a[0]).abs(), error };
    soup.iter().zip(errors.into_iter().cycle()).map(disc).collect()
}

impl<S: Scalar> Primitive for Disc<S> {
    type Scalar = S;

    fn aabb(&self) -> Aabb<S> {
        let ([x, y, z], r) = (self.center, self.radius);
        Aabb::new([x - r, y - r, z], [x + r, y + r, z])
    }
}

impl<S: Scalar> Intersect for Disc<S> {
    type Payload = [S; 3];
    type Leaf = OneByOne;

    fn intersect(&self, ray: &Ray<S>) -> Option<(S, [S; 3])> {
        let t = (self.center[2] - ray.origin[2]) / ray.direction[2];
        let point = ray.at(t);
        let [x, y] = [0, 1].map(|axis| point[axis] - self.center[axis]);
        (x * x + y * y <= self.radius * self.radius).then_some((t * self.error, point))
    }
}
