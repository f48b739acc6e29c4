// Box with a ball inside. Made by Gmsh 4.15.2: gmsh space.geo -3 -order ORDER -format msh22|msh41 [-bin]
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
Sphere(2) = {0.5, 0.5, 0.5, 0.3};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }
// The mesh is too coarse for curved elements.
Mesh.SecondOrderLinear = 1;
Mesh.MeshSizeMin = 0.5;
Mesh.MeshSizeMax = 0.5;
inner() = Volume In BoundingBox {0.1, 0.1, 0.1, 0.9, 0.9, 0.9};
all() = Volume{:};
Physical Volume("core", 4) = {inner()};
all() -= {inner()};
Physical Volume("shell", 9) = {all()};
Physical Surface("bottom", 1) = Surface In BoundingBox {-0.1, -0.1, -0.1, 1.1, 1.1, 0.1};
Physical Surface("sides", 2) = {Surface In BoundingBox {-0.1, -0.1, -0.1, 0.1, 1.1, 1.1}, Surface In BoundingBox {0.9, -0.1, -0.1, 1.1, 1.1, 1.1}, Surface In BoundingBox {-0.1, -0.1, -0.1, 1.1, 0.1, 1.1}, Surface In BoundingBox {-0.1, 0.9, -0.1, 1.1, 1.1, 1.1}};
Physical Surface("top", 3) = Surface In BoundingBox {-0.1, -0.1, 0.9, 1.1, 1.1, 1.1};
