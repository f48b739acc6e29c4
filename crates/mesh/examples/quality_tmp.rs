use mesh::*; use mesh::generate::*;
fn report(name:&str, m:&SimplexMesh<2>, h:&dyn Fn(&Point<2>)->f64, t:f64){
  let mut minang:f64=180.; let mut hist=[0;7]; 
  let (mut lo,mut hi,mut sum,mut ne)=(1e9f64,0f64,0.,0.);
  let mut worst=Point::<2>::zeros();
  for f in m.facets(){ let v=m.facet(f); let (a,b)=(m.vertex(v[0]),m.vertex(v[1])); let r=(a-b).norm()/h(&((a+b)*0.5)); lo=lo.min(r);hi=hi.max(r);sum+=r;ne+=1.;}
  for c in m.cells(){ let s=m.simplex(c); let p=s.points(); for i in 0..3 { let a=p[(i+1)%3]-p[i]; let b=p[(i+2)%3]-p[i]; let ang=(a.dot(&b)/a.norm()/b.norm()).acos().to_degrees(); if ang<minang{minang=ang;worst=p[i];} if ang<50.{hist[(((ang-20.)/5.).max(0.)) as usize]+=1;} } }
  let area:f64=m.cells().map(|c|m.cell_volume(c)).sum();
  println!("{name}: cells {} verts {} minangle {minang:.2} at {:?} edge/h mean {:.3} min {lo:.3} max {hi:.3} area {area:.10} t {:.3}s small {hist:?}", m.n_cells(), m.n_vertices(), worst.as_slice(), sum/ne, t);
}
fn main(){
  let g=Size::Graded{fine:0.1,fine_until:4.5,coarse:0.5,coarse_from:10.,axis:1};
  let t=std::time::Instant::now(); let m=graded_box::<2>([0.,0.],[10.,15.],&g).unwrap(); report("rigid",&m,&|x|g.at(x),t.elapsed().as_secs_f64());
  let g=Size::Graded{fine:0.05,fine_until:0.5,coarse:0.5,coarse_from:5.,axis:1};
  let t=std::time::Instant::now(); let m=graded_box::<2>([0.,-0.2],[10.,15.],&g).unwrap(); report("flex",&m,&|x|g.at(x),t.elapsed().as_secs_f64());
  for s in [0.2,0.3,0.4,0.6] { let g=Size::Graded{fine:0.1,fine_until:1.,coarse:1.0,coarse_from:1.+0.9/s,axis:1};
  let t=std::time::Instant::now(); if let Ok(m)=graded_box::<2>([0.,0.],[10.,10.],&g){ report(&format!("slope {s}"),&m,&|x|g.at(x),t.elapsed().as_secs_f64());} }
  for (w,hh,h) in [(1.,1.,0.1),(1.,1.,2.),(1.,0.1,0.3),(1.,1.9,1.),(1.,1.45,1.),(1.,1.,0.5),(1.,1.,0.33),(1.,1.,0.4),(3.,1.,0.25),(20.,0.2,0.3),(10.,15.,0.5),(1.,1.7,0.43),(7.3,2.2,0.9)] { let g=Size::uniform(h); let t=std::time::Instant::now(); match graded_box::<2>([0.,0.],[w,hh],&g){Ok(m)=>report(&format!("box {w} {hh} {h}"),&m,&|_|h.min(w).min(hh),t.elapsed().as_secs_f64()),Err(e)=>println!("box {w} {hh} {h} {e}")} }
  for (r,h) in [(1.,0.1),(4.,0.1),(4.,0.2),(4.,0.3),(1.,0.5),(1.,0.7),(1.,1.),(1.,0.3),(1.,0.05)] { let o=BallOptions{area_preserving:true}; let t=std::time::Instant::now();
   match ball::<2>([0.,7.],r,h,&o){Ok(m)=>report(&format!("ball {r} {h}"),&m,&|_|h,t.elapsed().as_secs_f64()),Err(e)=>println!("{e}")}
   let t=std::time::Instant::now();
   match half_ball::<2>([0.,7.],r,h,&o){Ok(m)=>{report(&format!("half {r} {h}"),&m,&|_|h,t.elapsed().as_secs_f64()); let mm=mirrored(&m,0,0.).unwrap(); report("   mirrored",&mm,&|_|h,0.); println!("{:?} {:?}",m.tag_names(),mm.tag_names());},Err(e)=>println!("{e}")} }
  // sweep
  let mut bad=0; let mut n=0; let mut worst=99.0f64;
  let mut seed=12345u64; let mut rnd=||{seed^=seed<<13;seed^=seed>>7;seed^=seed<<17;(seed>>11) as f64/(1u64<<53) as f64};
  let args:Vec<String>=std::env::args().collect(); let count:usize=args.get(1).and_then(|s|s.parse().ok()).unwrap_or(0);
  for _ in 0..count { let w=0.2+3.*rnd()*rnd(); let hh=0.2+4.*rnd()*rnd(); let h=0.04+1.5*rnd()*rnd(); let fine=h*(0.2+0.8*rnd()); let until=rnd()*hh; let slope=0.02+0.47*rnd(); let axis=(rnd()*2.) as usize;
   let g=if rnd()<0.4 {Size::uniform(h)} else {Size::Graded{fine,fine_until:until,coarse:h,coarse_from:until+(h-fine)/slope+1e-9,axis}};
   let (m,d)=if rnd()<0.6 {(graded_box::<2>([0.,0.],[w,hh],&g),format!("{w} {hh} {g:?}"))} else if rnd()<0.5 {(half_ball::<2>([0.,0.],w,h,&BallOptions::default()),format!("half {w} {h}"))} else {(ball::<2>([0.,0.],w,h,&BallOptions::default()),format!("ball {w} {h}"))};
   n+=1; match m {Err(e)=>{println!("ERR {d} {e}");bad+=1},Ok(m)=>{ let mut a0=180f64; for c in m.cells(){ let s=m.simplex(c); let p=s.points(); for i in 0..3 { let a=p[(i+1)%3]-p[i]; let b=p[(i+2)%3]-p[i]; a0=a0.min((a.dot(&b)/a.norm()/b.norm()).acos().to_degrees());}} worst=worst.min(a0); if a0<25.{bad+=1; println!("angle {a0:.2} {d}");}}} }
  println!("sweep {bad} bad of {n}, worst {worst}");
}
