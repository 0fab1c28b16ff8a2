import { svelte } from '@sveltejs/vite-plugin-svelte';
import { readFile, readdir, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';
import { defineConfig, type Plugin } from 'vite';

/** Writes every file a second time, compressed: these are what the program holds and serves. */
function compressed(): Plugin {
  let folder = 'dist';
  return {
    name: 'compressed',
    apply: 'build',
    configResolved: (config) => void (folder = config.build.outDir),
    async closeBundle() {
      const entries = await readdir(folder, { recursive: true, withFileTypes: true });
      const files = entries.filter((entry) => entry.isFile() && !entry.name.endsWith('.gz'));
      const paths = files.map((entry) => join(entry.parentPath, entry.name));
      await Promise.all(
        paths.map(async (path) => writeFile(`${path}.gz`, gzipSync(await readFile(path), { level: 9 }))),
      );
    },
  };
}

export default defineConfig({
  plugins: [svelte(), compressed()],
  build: { target: 'es2023', assetsInlineLimit: 0, reportCompressedSize: false, chunkSizeWarningLimit: 1000 },
  // `npm run dev` beside a studio that was started with --port 7117.
  server: {
    proxy: {
      '/engine': {
        target: 'ws://127.0.0.1:7117',
        ws: true,
        changeOrigin: true,
        // The studio refuses pages that it did not serve itself.
        headers: { origin: 'http://127.0.0.1:7117' },
      },
    },
  },
});
