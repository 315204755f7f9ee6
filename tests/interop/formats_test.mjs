// What readers from elsewhere see in caches: node formats_test.mjs GLB USDA PLY, of which the last is the last frame; see formats.sh.
import { readFileSync } from 'node:fs';
import validator from 'gltf-validator';
import init from 'tinyusdz/tinyusdz.js';

const [glb, usda, ply] = process.argv.slice(2);

function check(holds, sentence) {
  if (!holds) throw new Error(sentence);
}

const head = readFileSync(ply).toString('latin1');
const vertices = Number(/element vertex (\d+)/.exec(head)[1]);
const triangles = Number(/element face (\d+)/.exec(head)[1]);

const { issues, info } = await validator.validateBytes(new Uint8Array(readFileSync(glb)), { uri: glb });
check(issues.numErrors + issues.numWarnings === 0, `${glb}: ${JSON.stringify(issues.messages, null, 1)}`);
check(info.animationCount === 1 && info.hasMorphTargets, `${glb}: has no animation by morph targets`);
check(info.totalVertexCount === vertices && info.totalTriangleCount === triangles, `${glb}: ${JSON.stringify(info)}`);

// Its program is made for browsers: it looks for a window, refuses Node, and would fetch its code.
globalThis.window = globalThis;
process.type = 'renderer';
const instantiateWasm = (imports, receive) => {
  WebAssembly.instantiate(readFileSync('node_modules/tinyusdz/tinyusdz.wasm'), imports).then((made) => receive(made.instance, made.module));
  return {};
};
const usd = new (await init({ instantiateWasm })).TinyUSDZLoaderNative();
check(usd.loadFromBinary(new Uint8Array(readFileSync(usda)), usda), `${usda}: ${usd.error?.() ?? 'cannot be read'}`);
check(usd.numMeshes() === 1, `${usda}: has ${usd.numMeshes()} meshes`);
const mesh = usd.getMesh(0);
check(mesh.faceVertexIndices.length === 3 * triangles, `${usda}: has ${mesh.faceVertexIndices.length} corners of ${triangles} triangles`);
check(mesh.points.every(Number.isFinite), `${usda}: has points that are not finite`);

// The validator does find what is wrong.
const broken = new Uint8Array(readFileSync(glb));
broken[20] ^= 1;
const found = await validator.validateBytes(broken).then((report) => report.issues.numErrors, () => 1);
check(found > 0, 'the validator finds nothing in a file that is damaged');
console.log(`passed: ${glb} by Khronos' validator, ${usda} by tinyusdz; ${vertices} vertices, ${triangles} triangles`);
