// Rectangle with an elliptic inclusion. Made by Gmsh 4.15.2: gmsh plane.geo -2 -order ORDER -format msh22|msh41 [-bin]
SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 2, 1};
Ellipse(10) = {0.9, 0.5, 0, 0.4, 0.25};
Curve Loop(10) = {10};
Plane Surface(2) = {10};
BooleanFragments{ Surface{1}; Delete; }{ Surface{2}; Delete; }
Mesh.MeshSizeMin = 0.25;
Mesh.MeshSizeMax = 0.25;
inner() = Surface In BoundingBox {0.4, 0.2, -1, 1.4, 0.8, 1};
all() = Surface{:};
Physical Surface("hard part", 7) = {inner()};
all() -= {inner()};
Physical Surface("soft", 3) = {all()};
Physical Curve("left", 1) = Curve In BoundingBox {-0.1, -0.1, -1, 0.1, 1.1, 1};
Physical Curve("right", 2) = Curve In BoundingBox {1.9, -0.1, -1, 2.1, 1.1, 1};
Physical Curve("walls", 5) = {Curve In BoundingBox {-0.1, -0.1, -1, 2.1, 0.1, 1}, Curve In BoundingBox {-0.1, 0.9, -1, 2.1, 1.1, 1}};
