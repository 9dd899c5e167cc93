#!/bin/sh
# Makes three.bundle.js anew: what report-solid.js asks of three.js, in one script that defines THREE, licence in front.
# Needs Node, npm and its registry. Run it anywhere: sh make_three.sh
set -e
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
cd "$work"
npm init --yes >/dev/null
npm install --no-audit --no-fund three@0.187.0 esbuild@0.28.2 >/dev/null
cat >entry.js <<'END'
export {
  BufferAttribute, BufferGeometry, DoubleSide, DynamicDrawUsage, ExtrudeGeometry, Group, InstancedBufferAttribute,
  InstancedBufferGeometry, LineSegments, Mesh, PerspectiveCamera, Scene, ShaderMaterial, Shape, ShapeGeometry, Vector3,
  WebGLRenderer,
} from "three";
export { OrbitControls } from "three/addons/controls/OrbitControls.js";
END
# Template literals become strings, so that the code is one line; es2020 is what browsers of 2021 run.
npx esbuild entry.js --bundle --minify --format=iife --global-name=THREE --target=es2020 \
  --supported:template-literal=false --legal-comments=none --outfile=three.js
{
  printf '/*! three.js 0.187.0\n'
  cat node_modules/three/LICENSE
  printf '*/\n'
  cat three.js
} >"$here/three.bundle.js"
rm -r "$work"
