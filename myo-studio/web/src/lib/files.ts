/** Hands something to the browser to keep as a file. */
export function keep(contents: Blob | string, name: string, type = 'text/plain') {
  const blob = typeof contents === 'string' ? new Blob([contents], { type }) : contents;
  const link = Object.assign(document.createElement('a'), { href: URL.createObjectURL(blob), download: name });
  link.click();
  URL.revokeObjectURL(link.href);
}
